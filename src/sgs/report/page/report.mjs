// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { onMoment, parsedAxis, pixelOf, showMoment, timeAt } from "./moment.mjs";
import { makeScene } from "./scene.mjs";

// Pictures with a slider between camera and rendering.
for (const input of document.querySelectorAll(".slide input[type=range]")) {
  if (!(input instanceof HTMLInputElement)) continue;
  input.addEventListener("input", () =>
    input.parentElement?.style.setProperty("--x", input.value + "%"),
  );
}

// Plots over time: the cursor of all follows the pointer over one.
for (const svg of document.querySelectorAll("svg.time")) {
  if (!(svg instanceof SVGSVGElement)) continue;
  const axis = parsedAxis(svg.dataset.axis ?? "");
  const line = svg.appendChild(document.createElementNS(svg.namespaceURI, "path"));
  line.setAttribute("class", "cursor");
  onMoment((t) => {
    const u = t === null ? -1 : pixelOf(axis, t);
    line.setAttribute(
      "d",
      u < axis.left || u > axis.right ? "" : `M${u} ${axis.top}V${axis.bottom}`,
    );
  });
  svg.addEventListener("pointermove", (e) => {
    const box = svg.getBoundingClientRect();
    showMoment(timeAt(axis, ((e.clientX - box.left) / box.width) * svg.viewBox.baseVal.width));
  });
}

for (const box of document.querySelectorAll(".scene")) makeScene(box);
