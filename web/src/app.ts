// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { Choice, saveImage } from "./controls";
import { Connection } from "./data/connection";
import { GaussianStore } from "./data/gaussians";
import { Path } from "./data/path";
import {
  kProtocol,
  kViewPane,
  type Hello,
  type MapDiff,
  type Picture,
  type Refinement,
  type State,
  type TextMessage,
} from "./data/protocol";
import { need, setText } from "./dom";
import { Header } from "./header";
import { bindKeys } from "./keyboard";
import { Notice } from "./notice";
import { Panel } from "./panel/panel";
import { Panes } from "./panes";
import { preference, remember } from "./preferences";
import { SessionPanel } from "./session";
import { kCameraModes, type CameraMode } from "./stage/camera_rig";
import { kDisplayModes, Stage, type DisplayMode } from "./stage/stage";
import { onThemeChange } from "./theme";
import { publish, type PageState } from "./test_state";

/// Ties the parts together: what the server says goes to those who show it, what the user does goes
/// to the server.
export class App {
  private readonly store = new GaussianStore();
  private readonly path = new Path();
  private readonly header = new Header();
  private readonly panel = new Panel();
  private readonly notice = new Notice();
  private readonly session: SessionPanel;
  private readonly connection: Connection;
  private readonly stage: Stage;
  private readonly panes = new Panes(() => this.subscribe());
  private readonly displays: Choice<DisplayMode>;
  private readonly cameras: Choice<CameraMode>;
  /// The user's choice; null = the page decides.
  private wanted_mode = preference("mode", kDisplayModes);
  private hello: Hello | null = null;
  private state: State | null = null;

  constructor(url: string) {
    this.connection = new Connection(url, {
      open: () => this.opened(),
      closed: (retry_s) => this.closed(retry_s),
      text: (message) => this.receive(message),
      binary: (message) => this.receiveBinary(message),
    });
    this.stage = new Stage(this.store, this.path, (request) => this.connection.send(request));
    this.displays = new Choice("display-modes", (mode) => this.chooseMode(mode));
    this.cameras = new Choice("camera-modes", (mode) => this.chooseCamera(mode));
    this.displays.setAvailable(this.stage.available);
    this.chooseCamera(preference("camera", kCameraModes) ?? "follow", false);
    this.session = new SessionPanel(
      (action) => this.connection.send({ type: "control", action }),
      new URL(url).search,
    );
    this.bindButtons();
    this.bindShortcuts();
    publish(() => this.describe());
    onThemeChange(() => this.stage.requestDraw());
  }

  start(): void {
    this.notice.show("Connecting…");
    this.connection.connect();
  }

  private opened(): void {
    this.notice.hide();
    document.body.dataset["connected"] = "yes";
  }

  private closed(retry_s: number): void {
    document.body.dataset["connected"] = "no";
    const finished = this.state?.finished === true;
    this.notice.countDown(
      finished ? "The run is finished and its viewer has closed." : "The connection is lost.",
      retry_s,
    );
  }

  private receive(message: TextMessage): void {
    switch (message.type) {
      case "hello":
        this.greet(message);
        break;
      case "path":
        this.path.addChunk(message);
        this.stage.pathChanged();
        break;
      case "state":
        this.setState(message);
        break;
      case "metrics":
        this.panel.setMetrics(message);
        if (message.up) this.stage.standUpright(message.up);
        break;
      case "refinement":
        this.showRefinement(message);
        break;
      case "session":
        this.session.set(message);
        break;
      case "error":
        this.notice.show(message.message);
        break;
    }
  }

  private receiveBinary(message: MapDiff | Picture): void {
    if (message.kind === "map") {
      this.store.apply(message);
      this.stage.mapChanged();
    } else if (message.pane === kViewPane) {
      this.stage.receivePicture(message);
    } else {
      void this.panes.receive(message);
    }
  }

  /// Every connection starts from nothing: the server sends the whole path and map again. The
  /// viewpoint and the charts stay when it is the same run.
  private greet(hello: Hello): void {
    const same_run = this.hello?.input === hello.input && this.hello.tracker === hello.tracker;
    this.hello = hello;
    this.state = null;
    this.path.clear();
    this.store.clear();
    this.header.start(hello);
    this.session.start(hello);
    this.panel.start(hello.columns);
    if (same_run) {
      this.panel.setMetrics(null);
      this.stage.restart();
    } else {
      this.panel.clear();
      this.stage.start(hello);
    }
    if (hello.protocol !== kProtocol) {
      this.notice.show(
        `The viewer speaks protocol ${hello.protocol}, this page ${kProtocol}: reload it.`,
      );
    }
    need("transport").hidden = false;
    need("refine").hidden = !hello.refines;
    this.showRefinement(null);
    void this.applyMode();
  }

  private setState(state: State): void {
    this.state = state;
    this.path.addState(state);
    this.header.setState(state);
    this.panel.setState(state);
    this.stage.setState(state);
    this.session.setFinished(state.finished);
    this.showTransport(state);
    if (this.wanted_mode === null && this.automaticMode() !== this.stage.mode)
      void this.applyMode();
  }

  /// Pictures where the browser would have to draw splats on the processor, or too many of them.
  private automaticMode(): DisplayMode {
    const many = this.hello !== null && (this.state?.gaussians ?? 0) > this.hello.picture_above;
    return this.stage.webgl !== "hardware" || many ? "picture" : "splats";
  }

  private async applyMode(): Promise<void> {
    const wanted = this.wanted_mode ?? this.automaticMode();
    const mode = this.stage.available.includes(wanted) ? wanted : "picture";
    this.displays.set(mode);
    const changes = this.stage.setMode(mode);
    this.subscribe();
    await changes;
  }

  private chooseMode(mode: DisplayMode): void {
    this.wanted_mode = mode;
    remember("mode", mode);
    void this.applyMode();
  }

  private chooseCamera(mode: CameraMode, keep = true): void {
    if (keep) remember("camera", mode);
    this.cameras.set(mode);
    this.stage.setCameraMode(mode);
  }

  private subscribe(): void {
    const map = this.stage.subscription;
    // Without a subscription the copy grows stale; the server resends everything after the next one.
    if (map === "none") this.store.clear();
    this.connection.send({ type: "subscribe", map, panes: this.panes.wanted });
  }

  private togglePause(): void {
    const held = this.state?.paused || this.state?.finished;
    this.connection.send({ type: "control", action: held ? "resume" : "pause" });
  }

  private step(): void {
    this.connection.send({ type: "control", action: "step" });
  }

  private screenshot(): void {
    const frame = String(this.state?.frame ?? 0).padStart(6, "0");
    saveImage(this.stage.snapshot(), `sgs-${frame}.png`);
  }

  private showTransport(state: State): void {
    const pause = need<HTMLButtonElement>("pause");
    const replays = this.hello?.live === false;
    pause.disabled = state.finished && !replays;
    pause.setAttribute("aria-pressed", String(state.paused || (state.finished && replays)));
    const resume = state.finished && replays ? "Replay" : "Resume";
    setText(need("pause-label"), state.paused || (state.finished && replays) ? resume : "Pause");
    need<HTMLButtonElement>("step").disabled = state.finished;
  }

  private showRefinement(note: Refinement | null): void {
    this.session.setRefining(note?.running === true);
    const button = need<HTMLButtonElement>("refine");
    button.setAttribute("aria-pressed", String(note?.running === true));
    setText(need("refine-label"), note?.running ? "Enough" : "Refine");
    const percent = note?.running ? `${Math.round(100 * note.share)} %, ` : "";
    setText(need("refinement"), note ? percent + note.text : "");
  }

  private bindButtons(): void {
    need("refine").onclick = () => this.connection.send({ type: "control", action: "refine" });
    need("pause").onclick = () => this.togglePause();
    need("step").onclick = () => this.step();
    need("screenshot").onclick = () => this.screenshot();
    need("home").onclick = () => this.stage.rig.home();
  }

  private bindShortcuts(): void {
    bindKeys([
      { key: " ", shown: "Space", what: "pause or resume", run: () => this.togglePause() },
      { key: ".", what: "one frame", run: () => this.step() },
      { key: "r", what: "begin or end a recording", run: () => this.session.toggleRecording() },
      { key: "s", what: "save a screenshot", run: () => this.screenshot() },
      { key: "1", what: "splats drawn by the browser", run: () => this.chooseMode("splats") },
      { key: "2", what: "pictures drawn by the viewer", run: () => this.chooseMode("picture") },
      { key: "3", what: "points", run: () => this.chooseMode("points") },
      { key: "f", what: "camera follows", run: () => this.chooseCamera("follow") },
      { key: "o", what: "free orbit", run: () => this.chooseCamera("orbit") },
      { key: "p", what: "through the tracked camera", run: () => this.chooseCamera("first") },
      { key: "h", what: "back to the standard view", run: () => this.stage.rig.home() },
      { key: "m", what: "the whole map in view", run: () => this.stage.overview() },
      { key: "i", what: "show or hide the images", run: () => this.panes.toggle() },
    ]);
  }

  private describe(): PageState {
    return {
      connected: this.connection.connected,
      frame: this.state?.frame ?? -1,
      gaussians: this.state?.gaussians ?? 0,
      gaussians_held: this.store.count,
      map_version: this.state?.map_version ?? 0,
      held_version: this.store.version,
      mode: this.stage.mode,
      camera: this.stage.rig.mode,
      webgl: this.stage.webgl,
      picture: this.stage.picture.shown,
      status_text: this.panel.status_text,
      mask: this.state?.mask ?? 0,
      paused: this.state?.paused ?? false,
      finished: this.state?.finished ?? false,
      session: this.session.last,
    };
  }
}
