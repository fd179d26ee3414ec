// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { Control, Hello, Session } from "./data/protocol";
import { droppedWords, sentence } from "./data/session_words";
import { make, need, setText } from "./dom";

/// What a run that goes on can be asked for, how it fares, and what whoever holds the camera should
/// hear.
export class SessionPanel {
  private readonly record = need<HTMLButtonElement>("record");
  private readonly finish = need<HTMLButtonElement>("finish");
  private readonly refine = need<HTMLButtonElement>("finish-refine");
  private readonly save = need<HTMLButtonElement>("save");
  private readonly again = need<HTMLButtonElement>("again");
  private note: Session | null = null;
  private finished = false;
  private refining = false;

  /// `query` goes behind the addresses of downloads.
  constructor(
    private readonly send: (action: Control) => void,
    private readonly query: string,
  ) {
    this.record.onclick = () => this.toggleRecording();
    this.save.onclick = () => this.send("save");
    this.finish.onclick = () => this.send("finish");
    this.refine.onclick = () => this.send(this.refining ? "refine" : "finish_and_refine");
    this.again.onclick = () => this.send("start_again");
  }

  start(hello: Hello): void {
    need("session").hidden = hello.session !== true;
    this.record.hidden = hello.records !== true;
    this.again.hidden = hello.starts_again !== true;
    this.note = null;
    this.finished = false;
    this.refining = false;
    this.show();
  }

  set(note: Session): void {
    this.note = note;
    this.show();
  }

  setFinished(finished: boolean): void {
    if (finished === this.finished) return;
    this.finished = finished;
    this.show();
  }

  setRefining(running: boolean): void {
    this.refining = running;
    this.show();
  }

  get warnings(): string[] {
    return this.note?.warnings.map(({ key }) => key) ?? [];
  }

  get last(): Session | null {
    return this.note;
  }

  toggleRecording(): void {
    if (!this.record.hidden && !this.record.disabled)
      this.send(this.note?.recording ? "stop_recording" : "record");
  }

  private show(): void {
    const over = this.finished || this.note?.ended === true;
    this.record.disabled = over;
    this.record.setAttribute("aria-pressed", String(this.note?.recording === true));
    setText(need("record-label"), this.note?.recording ? "Stop recording" : "Record");
    this.save.disabled = over;
    this.finish.disabled = over;
    const ready = this.note?.refinable === true && (!over || this.note.ended);
    this.refine.disabled = !ready && !this.refining;
    this.refine.title = ready
      ? "Ends the run and learns the map on for three minutes"
      : "Only what was recorded can be learned from again";
    setText(
      need("finish-refine-label"),
      this.refining ? "Enough" : over ? "Refine" : "Finish and refine",
    );
    this.showLines();
    this.showWarnings();
    this.showDownloads();
  }

  private showLines(): void {
    const note = this.note;
    const line = (id: string, text: string, trouble = false) => {
      const element = need(id);
      element.hidden = text === "";
      element.classList.toggle("trouble", trouble);
      setText(element, text);
    };
    line("camera-line", note ? droppedWords(note) : "", (note?.dropped ?? 0) > 0);
    line("trouble-line", note ? sentence(note.trouble) : "", true);
    line("recorded-line", note?.recorded ? `recorded: ${note.recorded}` : "");
    line("disk-line", note ? sentence(note.recording_trouble) : "", true);
    line("saved-line", note ? sentence(note.saved) : "");
  }

  private showWarnings(): void {
    const list = need("warnings");
    const warnings = this.note?.warnings ?? [];
    list.hidden = warnings.length === 0;
    const shown = [...list.children].map((item) => (item as HTMLElement).dataset["key"]);
    if (shown.join() !== warnings.map(({ key }) => key).join()) {
      list.replaceChildren(
        ...warnings.map(({ key }) => {
          const item = make("li");
          item.dataset["key"] = key;
          return item;
        }),
      );
    }
    warnings.forEach(({ text }, i) => setText(list.children[i]!, `⚠ ${sentence(text)}`));
  }

  private showDownloads(): void {
    const box = need("downloads");
    const names = this.note?.downloads ?? [];
    box.hidden = names.length === 0;
    if (box.dataset["names"] === names.join()) return;
    box.dataset["names"] = names.join();
    box.replaceChildren(
      ...names.map((name) => {
        const link = make("a", "", name);
        link.href = `download/${encodeURIComponent(name)}${this.query}`;
        link.download = name;
        return link;
      }),
    );
  }
}
