// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import {
  decodeBinary,
  parseText,
  type MapDiff,
  type Picture,
  type Request,
  type TextMessage,
} from "./protocol";

export interface ConnectionEvents {
  open(): void;
  /// `retry_s`: seconds until the next attempt.
  closed(retry_s: number): void;
  text(message: TextMessage): void;
  binary(message: MapDiff | Picture): void;
}

export const kFirstRetry_s = 0.5;
export const kLongestRetry_s = 10;

/// Seconds to wait before attempt number `attempt` (0 = first repeat).
export function retryDelay(attempt: number): number {
  return Math.min(kLongestRetry_s, kFirstRetry_s * 2 ** attempt);
}

/// One WebSocket that comes back: after a loss it is tried again, ever more slowly.
export class Connection {
  private socket: WebSocket | null = null;
  private attempt = 0;
  private timer = 0;

  constructor(
    private readonly url: string,
    private readonly events: ConnectionEvents,
  ) {
    // A page that comes back to the front, or a network that does, need not wait.
    addEventListener("online", () => this.retryNow());
    document.addEventListener("visibilitychange", () => {
      if (!document.hidden) this.retryNow();
    });
  }

  get connected(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  connect(): void {
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.attempt = 0;
      this.events.open();
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => this.receive(event.data);
    socket.onclose = () => {
      this.socket = null;
      const delay_s = retryDelay(this.attempt++);
      this.timer = window.setTimeout(() => this.retryNow(), delay_s * 1000);
      this.events.closed(delay_s);
    };
  }

  retryNow(): void {
    if (this.socket) return;
    window.clearTimeout(this.timer);
    this.connect();
  }

  send(request: Request): boolean {
    if (!this.connected) return false;
    this.socket?.send(JSON.stringify(request));
    return true;
  }

  private receive(data: string | ArrayBuffer): void {
    const message = typeof data === "string" ? parseText(data) : decodeBinary(data);
    if (!message) {
      console.warn("a message of the viewer could not be read");
    } else if ("kind" in message && typeof data !== "string") {
      this.events.binary(message as MapDiff | Picture);
    } else {
      this.events.text(message as TextMessage);
    }
  }
}
