// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Reads an MCAP file of ROS 2 messages with libraries that share no code with its writer:
//   node read_mcap.mjs FILE
// Prints JSON: {profile, messages: [{topic, type, time_ns, value}], counts: {topic: n from the
// statistics}}. Messages are decoded by the definitions that the file carries, which must say the
// same as those of ROS 2. Bytes become base64.
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";

const file = await open(process.argv[2], "r");
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, size) => {
    const bytes = new Uint8Array(Number(size));
    await file.read(bytes, 0, Number(size), Number(offset));
    return bytes;
  },
};

const bare = (type) => type.replace("/msg/", "/");
const shape = (definition) =>
  definition.definitions.map((f) => [f.name, bare(f.type), f.isArray ?? false, f.value ?? null]);

/** The parts of a schema, each compared with ROS 2's own. */
function definitions(schema) {
  const parts = parse(new TextDecoder().decode(schema.data), { ros2: true });
  for (const part of parts) {
    const name = bare(part.name ?? schema.name);
    const known = Object.values(ros2humble).find((d) => bare(d.name ?? "") === name);
    if (!known) throw new Error(`ROS 2 has no ${name}`);
    if (name === "builtin_interfaces/Time") continue; // a primitive for the reader
    if (JSON.stringify(shape(part)) !== JSON.stringify(shape(known))) {
      throw new Error(`${name}: ${JSON.stringify(shape(part))} / ${JSON.stringify(shape(known))}`);
    }
  }
  return parts;
}

const reader = await McapIndexedReader.Initialize({ readable });
const readers = new Map();
const messages = [];
const plain = (key, value) => {
  if (typeof value === "bigint") return String(value);
  return value instanceof Uint8Array ? Buffer.from(value).toString("base64") : value;
};
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!readers.has(channel.id)) readers.set(channel.id, new MessageReader(definitions(schema)));
  messages.push({
    topic: channel.topic,
    type: schema.name,
    time_ns: message.logTime,
    value: readers.get(channel.id).readMessage(message.data),
  });
}
const counts = {};
for (const [id, count] of reader.statistics.channelMessageCounts) {
  counts[reader.channelsById.get(id).topic] = Number(count);
}
console.log(JSON.stringify({ profile: reader.header.profile, messages, counts }, plain));
