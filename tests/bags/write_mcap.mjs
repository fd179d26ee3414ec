// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes messages as MCAP or packs them as CDR, with libraries that share no code with the reader:
//   node write_mcap.mjs PLAN.json
// The plan: {cdr: bool, compression: "", "lz4" or "zstd", mcap: path or null, blobs: path or null,
// messages: [{topic, type, time_ns, file (bytes) or value (an object; {"$file": path} = bytes)}]}.
// With `blobs`, the packed messages are written one after the other, each behind its 32-bit length.
import { execFileSync } from "node:child_process";
import { openSync, readFileSync, writeFileSync, writeSync } from "node:fs";
import { McapWriter } from "@mcap/core";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";

const plan = JSON.parse(readFileSync(process.argv[2], "utf8"));

/** Definitions of a type and of all that it consists of, the type itself first. */
function definitions(type, seen = new Map()) {
  const definition = ros2humble[type] ?? ros2humble[type.replace("/msg/", "/")];
  if (!definition) throw new Error(`unknown type ${type}`);
  if (!seen.has(type)) {
    seen.set(type, { ...definition, name: type });
    for (const field of definition.definitions) {
      if (field.isComplex) definitions(field.type, seen);
    }
  }
  return [...seen.values()];
}

/** Files become bytes. */
function load(value) {
  if (Array.isArray(value)) return value.map(load);
  if (value === null || typeof value !== "object") return value;
  if (value.$file) return new Uint8Array(readFileSync(value.$file));
  return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, load(part)]));
}

const writers = new Map();
function pack(message) {
  if (message.file) return new Uint8Array(readFileSync(message.file));
  if (!writers.has(message.type)) {
    writers.set(message.type, new MessageWriter(definitions(message.type)));
  }
  return writers.get(message.type).writeMessage(load(message.value));
}

const packed = plan.messages.map(pack);

if (plan.blobs) {
  const parts = [];
  for (const bytes of packed) {
    const length = Buffer.alloc(4);
    length.writeUInt32LE(bytes.byteLength);
    parts.push(length, Buffer.from(bytes));
  }
  writeFileSync(plan.blobs, Buffer.concat(parts));
}

if (plan.mcap) {
  const file = openSync(plan.mcap, "w");
  let size = 0n;
  const writable = {
    write: async (bytes) => {
      writeSync(file, bytes);
      size += BigInt(bytes.byteLength);
    },
    position: () => size,
  };
  const options = { input: undefined, maxBuffer: 1 << 30 };
  const compressChunk = (bytes) =>
    plan.compression === ""
      ? { compression: "", compressedData: bytes }
      : {
          compression: plan.compression,
          compressedData: execFileSync(plan.compression, ["-c", "-q"], {
            ...options,
            input: bytes,
          }),
        };
  const writer = new McapWriter({ writable, compressChunk, chunkSize: 1 << 20 });
  await writer.start({ profile: plan.cdr ? "ros2" : "ros1", library: "test" });
  const channels = new Map();
  for (const [i, message] of plan.messages.entries()) {
    if (!channels.has(message.topic)) {
      const schemaId = await writer.registerSchema({
        name: message.type,
        encoding: plan.cdr ? "ros2msg" : "ros1msg",
        data: new Uint8Array(),
      });
      const id = await writer.registerChannel({
        topic: message.topic,
        schemaId,
        messageEncoding: plan.cdr ? "cdr" : "ros1",
        metadata: new Map(),
      });
      channels.set(message.topic, id);
    }
    await writer.addMessage({
      channelId: channels.get(message.topic),
      sequence: i,
      logTime: BigInt(message.time_ns),
      publishTime: BigInt(message.time_ns),
      data: packed[i],
    });
  }
  await writer.end();
}
