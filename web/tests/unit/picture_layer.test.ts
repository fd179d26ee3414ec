// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { PerspectiveCamera } from "three";
import { kViewPane, type Picture, type Request } from "../../src/data/protocol";
import { PictureLayer } from "../../src/stage/picture_layer";

/// A browser of which the test says when a picture is decoded.
function fakeBrowser() {
  const decoded: (() => void)[] = [];
  const bitmap = { width: 4, height: 3, close() {} };
  Object.assign(globalThis, {
    window: globalThis,
    devicePixelRatio: 1,
    createImageBitmap: () => new Promise((resolve) => decoded.push(() => resolve(bitmap))),
  });
  const drawn: unknown[] = [];
  const canvas = {
    clientWidth: 4,
    clientHeight: 3,
    getContext: () => ({ drawImage: (picture: unknown) => drawn.push(picture) }),
  };
  return { decoded, drawn, canvas: canvas as unknown as HTMLCanvasElement };
}

test("a picture that is decoded after its mode was left is not shown", async () => {
  const { decoded, drawn, canvas } = fakeBrowser();
  const asked: Request[] = [];
  const layer = new PictureLayer(
    canvas,
    (request) => asked.push(request) > 0,
    () => {},
  );
  const camera = new PerspectiveCamera();
  const picture = (sequence: number): Picture => {
    return { kind: "picture", pane: kViewPane, sequence, jpeg: new Uint8Array(1) };
  };

  await new Promise((resolve) => setTimeout(resolve, 70)); // the shortest gap between requests
  layer.request(camera);
  assert.equal(asked.length, 1);
  const late = layer.receive(picture(1), camera);
  layer.request(camera); // waits for the answer
  layer.reset();
  decoded[0]!();
  await late;
  assert.equal(layer.shown, 0);
  assert.equal(drawn.length, 0);
  assert.equal(asked.length, 1, "nobody wants pictures any more");

  await new Promise((resolve) => setTimeout(resolve, 70));
  layer.request(camera);
  const answer = layer.receive(picture(2), camera);
  decoded[1]!();
  await answer;
  assert.equal(layer.shown, 2);
  assert.equal(drawn.length, 1);
});
