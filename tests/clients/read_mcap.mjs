// Decodes every message of a recording as a viewer of Foxglove does; prints what it found as JSON.
import { open } from 'node:fs/promises';
import { McapIndexedReader } from '@mcap/core';
import { FileHandleReadable } from '@mcap/nodejs';
import { loadDecompressHandlers } from '@mcap/support';
import { parse } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg2-serialization';

const file = await open(process.argv[2], 'r');
const recording = await McapIndexedReader.Initialize({
  readable: new FileHandleReadable(file),
  decompressHandlers: await loadDecompressHandlers(),
});
const decoders = new Map();
for (const [id, schema] of recording.schemasById) {
  decoders.set(id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
}
const counts = {};
const transforms = new Set();
let description = '';
let nearest = Infinity;
for await (const { channelId, data } of recording.readMessages()) {
  const { topic, schemaId } = recording.channelsById.get(channelId);
  const message = decoders.get(schemaId).readMessage(data);
  counts[topic] = (counts[topic] ?? 0) + 1;
  if (topic.startsWith('/tf')) for (const each of message.transforms) transforms.add(each.child_frame_id);
  if (topic === '/robot_description') description = message.data;
  if (topic === '/scan') nearest = Math.min(nearest, ...message.ranges);
}
await file.close();
console.log(JSON.stringify({ counts, transforms: [...transforms].sort(), description, nearest }));
