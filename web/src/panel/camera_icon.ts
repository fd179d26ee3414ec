// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { ShownAxis } from "../data/axes";
import { makeSvg, need, setAttributes } from "../dom";

type Point3 = readonly [number, number, number];
type Point2 = [number, number];

/// The icon looks at the camera from behind, above and right; parallel projection of camera axes
/// (x right, y down, z forward) to the page.
const kProjection: readonly [Point2, Point2, Point2] = [
  [0.9, 0.26],
  [0, 0.92],
  [0.5, -0.42],
];
const kArrow_px = 92;
const kTurnAt = -0.72;
const kTurnRadius = 0.24;
const kLetters = "xyz";

function project(p: Point3): Point2 {
  const [a, b, c] = kProjection;
  return [
    kArrow_px * (p[0] * a[0] + p[1] * b[0] + p[2] * c[0]),
    kArrow_px * (p[0] * a[1] + p[1] * b[1] + p[2] * c[1]),
  ];
}

function pathOf(points: Point2[], closed = false): string {
  const text = points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join(" L");
  return `M${text}${closed ? "Z" : ""}`;
}

/// Arrow head at `tip` coming from `from`.
function head(tip: Point2, from: Point2, size: number): Point2[] {
  const [dx, dy] = [tip[0] - from[0], tip[1] - from[1]];
  const length = Math.hypot(dx, dy) || 1;
  const [ux, uy] = [dx / length, dy / length];
  const back: Point2 = [tip[0] - size * ux, tip[1] - size * uy];
  return [
    tip,
    [back[0] - 0.5 * size * uy, back[1] + 0.5 * size * ux],
    [back[0] + 0.5 * size * uy, back[1] - 0.5 * size * ux],
  ];
}

function cross(a: Point3, b: Point3): Point3 {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/// One arrow: a straight one for sliding, an arc around its axis for turning.
class AxisGlyph {
  private readonly group = makeSvg("g");
  private readonly shaft = makeSvg("path", { class: "shaft" });
  private readonly tip = makeSvg("path", { class: "tip" });
  private readonly label = makeSvg("text");

  constructor(parent: SVGElement) {
    this.group.append(this.shaft, this.tip, this.label);
    parent.append(this.group);
  }

  update(axis: ShownAxis): void {
    const letter = kLetters[axis.letter]!;
    this.group.setAttribute("class", `axis ${axis.kind} ${axis.unseen ? "unseen" : "seen"}`);
    // Between seen and unseen the colour blends and the line thins out.
    this.group.style.setProperty("--weight", axis.weight.toFixed(3));
    if (axis.kind === "slide") this.drawSlide(axis.direction);
    else this.drawTurn(axis.direction);
    this.label.textContent = axis.kind === "slide" ? letter : `↻${letter}`;
  }

  private drawSlide(d: Point3): void {
    const start = project([0.2 * d[0], 0.2 * d[1], 0.2 * d[2]]);
    const end = project(d);
    const length = Math.hypot(...end);
    if (length < 30) {
      // The arrow points at the reader: show its tip from the front.
      this.shaft.setAttribute("d", pathOf(circle(end, 7), true));
      this.tip.setAttribute("d", pathOf(circle(end, 2), true));
      this.place([end[0] + 15, end[1]]);
      return;
    }
    const [ux, uy] = [end[0] / length, end[1] / length];
    this.shaft.setAttribute("d", pathOf([start, [end[0] - 13 * ux, end[1] - 13 * uy]]));
    this.tip.setAttribute("d", pathOf(head(end, start, 14), true));
    this.place([end[0] + 12 * ux, end[1] + 12 * uy]);
  }

  private drawTurn(d: Point3): void {
    // Two directions across the axis span the circle.
    const helper: Point3 = Math.abs(d[1]) < 0.8 ? [0, 1, 0] : [1, 0, 0];
    const a = unit(cross(d, helper));
    const b = cross(d, a);
    const points: Point2[] = [];
    for (let i = 0; i <= 28; ++i) {
      const angle = -0.6 + (1.62 * Math.PI * i) / 28;
      const [c, s] = [kTurnRadius * Math.cos(angle), kTurnRadius * Math.sin(angle)];
      points.push(
        project([0, 1, 2].map((k) => kTurnAt * d[k]! + c * a[k]! + s * b[k]!) as unknown as Point3),
      );
    }
    const last = points[points.length - 1]!;
    this.shaft.setAttribute("d", pathOf(points.slice(0, -2)));
    this.tip.setAttribute("d", pathOf(head(last, points[points.length - 4]!, 11), true));
    const at = project([1.5 * kTurnAt * d[0], 1.5 * kTurnAt * d[1], 1.5 * kTurnAt * d[2]]);
    this.place(at);
  }

  private place(at: Point2): void {
    setAttributes(this.label, { x: at[0].toFixed(1), y: at[1].toFixed(1) });
  }
}

function unit(v: Point3): Point3 {
  const norm = Math.hypot(...v) || 1;
  return [v[0] / norm, v[1] / norm, v[2] / norm];
}

function circle(centre: Point2, radius: number): Point2[] {
  return Array.from({ length: 20 }, (_, i) => [
    centre[0] + radius * Math.cos((i * Math.PI) / 10),
    centre[1] + radius * Math.sin((i * Math.PI) / 10),
  ]);
}

/// The camera's body: a box with a lens, drawn by its visible edges.
function drawBody(parent: SVGElement): void {
  const [w, h, d] = [0.2, 0.14, 0.1];
  const face = (points: Point3[], className: string) =>
    parent.append(makeSvg("path", { d: pathOf(points.map(project), true), class: className }));
  face(
    [
      [-w, -h, -d],
      [w, -h, -d],
      [w, h, -d],
      [-w, h, -d],
    ],
    "body",
  );
  face(
    [
      [-w, -h, -d],
      [w, -h, -d],
      [w, -h, d],
      [-w, -h, d],
    ],
    "body top",
  );
  face(
    [
      [w, -h, -d],
      [w, h, -d],
      [w, h, d],
      [w, -h, d],
    ],
    "body side",
  );
}

/// The camera with its six axes.
export class CameraIcon {
  private readonly glyphs: AxisGlyph[];

  constructor() {
    const svg = need<SVGSVGElement>("camera-icon");
    svg.setAttribute("viewBox", "-118 -107 236 214");
    // Light lines mark where the axes run; arrows lie on them.
    const guides = makeSvg("g", { class: "guides" });
    svg.append(guides);
    for (const axis of [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ] as Point3[]) {
      const [a, b] = [project([-axis[0], -axis[1], -axis[2]]), project(axis)];
      guides.append(makeSvg("path", { d: pathOf([a, b]) }));
    }
    drawBody(svg);
    this.glyphs = Array.from({ length: 6 }, () => new AxisGlyph(svg));
  }

  /// `axes` null: their directions are not known, there is nothing to draw.
  update(axes: readonly ShownAxis[] | null): void {
    need("axes-figure").hidden = axes === null;
    need("axes-unknown").hidden = axes !== null;
    axes?.forEach((axis, i) => this.glyphs[i]!.update(axis));
  }
}
