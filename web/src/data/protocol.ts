// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

/// What the server says (docs/viewer.md, "Protocol"), decoded. All numbers SI; poses map camera to
/// world, camera x right, y down, z forward.

export const kProtocol = 2;

/// tx ty tz qx qy qz qw
export type Pose = [number, number, number, number, number, number, number];
export type Six<T = number> = [T, T, T, T, T, T];
export type Status = "ok" | "degenerate" | "lost";
export const kStatuses: readonly Status[] = ["ok", "degenerate", "lost"];

export interface Camera {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  width: number;
  height: number;
}

/// A per-frame value: its key in State.values and in frames.csv.
export interface FrameColumn {
  key: string;
  unit: string;
  meaning: string;
}

export interface Hello {
  type: "hello";
  protocol: number;
  version: string;
  input: string;
  tracker: string;
  preset: string;
  live: boolean;
  /// The map can be refined from here.
  refines: boolean;
  /// The run can be finished and saved from here, recorded, and started again. Older viewers say
  /// nothing of it.
  session?: boolean;
  records?: boolean;
  starts_again?: boolean;
  camera: Camera;
  up: [number, number, number] | null;
  frames_total: number | null;
  picture_above: number;
  columns: FrameColumn[];
}

export interface PathChunk {
  type: "path";
  first: number;
  estimate: (Pose | null)[];
  truth: (Pose | null)[];
  status: number[];
}

export interface State {
  type: "state";
  frame: number;
  time: number;
  status: Status;
  /// Why a lost frame is lost, in a sentence; null = it is not.
  lost: string | null;
  /// Every per-frame value, by the keys of Hello.columns. What follows below is taken from it, as
  /// far as this page computes with it.
  values: Readonly<Record<string, unknown>>;
  pose: Pose | null;
  truth: Pose | null;
  keyframe: boolean;
  map_version: number;
  gaussians: number;
  /// Signal over noise per axis; null = infinite. 0 = least seen.
  snr: Six<number | null> | null;
  /// 0 = seen by geometry .. 1 = unseen.
  weights: Six;
  /// Unit twists in the camera frame, rotation first; null = not known.
  axes: Six<Six> | null;
  mask: number;
  condition: number | null;
  planarity: number | null;
  prior_active: boolean;
  prior_source: string;
  ms: { track: number | null; map: number | null };
  fps: number | null;
  paused: boolean;
  finished: boolean;
}

/// A score as it is printed everywhere.
export interface MetricLine {
  key: string;
  group: string;
  label: string;
  value: string;
  meaning: string;
  /// One of the few that matter most.
  main: boolean;
}

export interface Metrics {
  type: "metrics";
  lines: MetricLine[];
  /// Upright in the world of the map, as the finished run found it.
  up: [number, number, number] | null;
}

/// How the refinement fares that somebody asked for.
export interface Refinement {
  type: "refinement";
  running: boolean;
  /// Of the effort, 0..1.
  share: number;
  text: string;
}

/// How a run that goes on fares beside its frames.
export interface Session {
  type: "session";
  at_camera_rate: boolean;
  dropped: number;
  /// Came while the run was paused.
  left_out: number;
  /// Frames that come per second.
  camera_fps: number | null;
  why_dropped: string;
  /// To whoever holds the camera.
  warnings: { key: string; text: string }[];
  /// What the input suffers from.
  trouble: string;
  recording: boolean;
  /// What has been recorded, in words.
  recorded: string;
  recording_trouble: string;
  /// What the last save came to.
  saved: string;
  /// The map can be refined at the end.
  refinable: boolean;
  /// The run's results are complete.
  ended: boolean;
  /// Names below download/.
  downloads: string[];
}

export interface Problem {
  type: "error";
  message: string;
}

export type TextMessage = Hello | PathChunk | State | Metrics | Refinement | Session | Problem;

const kTextTypes = new Set(["hello", "path", "state", "metrics", "refinement", "session", "error"]);

/// A state as it is sent: the page's own fields are filled from `values`.
type SentState = Pick<
  State,
  | "type"
  | "frame"
  | "time"
  | "status"
  | "lost"
  | "values"
  | "pose"
  | "truth"
  | "map_version"
  | "gaussians"
  | "fps"
  | "paused"
  | "finished"
> & { map_ms: number | null };

function completeState({ map_ms, ...sent }: SentState): State {
  const v = sent.values as Record<string, never>;
  return {
    ...sent,
    keyframe: v["mapping_keyframe"]!,
    snr: v["snr"]!,
    weights: v["weight"]!,
    axes: v["axis"]!,
    mask: v["degenerate_mask"]!,
    condition: v["condition_number"]!,
    planarity: v["planarity"]!,
    prior_active: v["prior_active"]!,
    prior_source: v["prior_source"]!,
    ms: { track: v["track_ms"]!, map: map_ms },
  };
}

/// The message, or null for anything that is not one of ours.
export function parseText(text: string): TextMessage | null {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    return null;
  }
  if (typeof value !== "object" || value === null) return null;
  const type = (value as { type?: unknown }).type;
  if (typeof type !== "string" || !kTextTypes.has(type)) return null;
  if (type !== "state") return value as TextMessage;
  const { values } = value as { values?: unknown };
  return typeof values === "object" && values !== null ? completeState(value as SentState) : null;
}

/// Gaussians that were added or changed, and ids that are gone.
export interface MapDiff {
  kind: "map";
  /// Forget everything first.
  reset: boolean;
  /// No further message of this version follows.
  last: boolean;
  version: number;
  count: number;
  /// `count` records of kRecordWords words: id, position, scales, quaternion w x y z, RGBA bytes.
  floats: Float32Array;
  /// The same memory.
  words: Uint32Array;
  removed: Uint32Array;
  /// Of the spherical harmonics of these Gaussians' colours; 0 = none.
  degree: number;
  /// `count` times harmonicBytes(degree) bytes.
  harmonics: Uint8Array;
}

export const kRecordWords = 12;
export const kMaxDegree = 3;

/// Bytes per Gaussian: 128 + 128 times a coefficient, basis function by basis function, red green blue
/// each; padded.
export const harmonicBytes = (degree: number): number => 16 * degree;

/// Panes of a picture message, in the order of their numbers.
export const kPanes = ["color", "depth", "render", "error"] as const;
export type Pane = (typeof kPanes)[number];
export const kViewPane = 4;

export interface Picture {
  kind: "picture";
  pane: number;
  sequence: number;
  jpeg: Uint8Array<ArrayBuffer>;
}

const kMapHeaderBytes = 24;
const kPictureHeaderBytes = 8;

function decodeMap(view: DataView<ArrayBuffer>): MapDiff | null {
  if (view.byteLength < kMapHeaderBytes) return null;
  const flags = view.getUint8(1);
  const count = view.getUint32(16, true);
  const removed = view.getUint32(20, true);
  const degree = view.getUint8(2);
  if (degree > kMaxDegree) return null;
  const records_bytes = count * kRecordWords * 4;
  const harmonics_at = kMapHeaderBytes + records_bytes + removed * 4;
  const harmonics_bytes = count * harmonicBytes(degree);
  if (view.byteLength !== harmonics_at + harmonics_bytes) return null;
  return {
    kind: "map",
    reset: (flags & 1) !== 0,
    last: (flags & 2) !== 0,
    version: Number(view.getBigUint64(8, true)),
    count,
    // Typed arrays take the machine's byte order: little-endian wherever browsers run today.
    floats: new Float32Array(view.buffer, kMapHeaderBytes, count * kRecordWords),
    words: new Uint32Array(view.buffer, kMapHeaderBytes, count * kRecordWords),
    removed: new Uint32Array(view.buffer, kMapHeaderBytes + records_bytes, removed),
    degree,
    harmonics: new Uint8Array(view.buffer, harmonics_at, harmonics_bytes),
  };
}

/// The message, or null where it is malformed.
export function decodeBinary(buffer: ArrayBuffer): MapDiff | Picture | null {
  if (buffer.byteLength < kPictureHeaderBytes) return null;
  const view = new DataView(buffer);
  switch (view.getUint8(0)) {
    case 1:
      return decodeMap(view);
    case 2:
      return {
        kind: "picture",
        pane: view.getUint8(1),
        sequence: view.getUint32(4, true),
        jpeg: new Uint8Array(buffer, kPictureHeaderBytes),
      };
    default:
      return null;
  }
}

export type Control =
  | "pause"
  | "resume"
  | "step"
  | "refine"
  | "save"
  | "record"
  | "stop_recording"
  | "finish"
  | "finish_and_refine"
  | "start_again";
export type MapSubscription = "splats" | "points" | "none";

export type Request =
  | { type: "control"; action: Control }
  | { type: "subscribe"; map: MapSubscription; panes: Pane[] }
  | { type: "view"; seq: number; pose: Pose; fov_y: number; width: number; height: number };
