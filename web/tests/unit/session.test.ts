// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { parseText } from "../../src/data/protocol";
import { droppedWords, sentence } from "../../src/data/session_words";

test("sentences begin and end as such", () => {
  assert.equal(sentence(""), "");
  assert.equal(sentence("it is dark"), "It is dark.");
  assert.equal(sentence("Is it dark?"), "Is it dark?");
});

test("what becomes of frames is said with its reason", () => {
  const calm = { camera_fps: 29.8, dropped: 0, left_out: 0, why_dropped: "" };
  assert.equal(droppedWords({ ...calm, camera_fps: null }), "");
  assert.equal(droppedWords(calm), "30 frames/s come");
  assert.equal(
    droppedWords({ ...calm, dropped: 3, why_dropped: "tracking takes 41 ms", left_out: 7 }),
    "30 frames/s come; 3 dropped: tracking takes 41 ms; 7 left out while paused",
  );
});

test("the session's message is read, and what a newer viewer may say is not", () => {
  assert.equal(parseText('{"type":"session","dropped":2}')?.type, "session");
  assert.equal(parseText('{"type":"something else"}'), null);
});
