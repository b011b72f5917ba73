import assert from "node:assert/strict";
import { test } from "node:test";
import { Connection, ConnectionLost, CoreError, type TransportEvents } from "../../src/connection";

interface Sent {
  id: number;
  type: string;
  [key: string]: unknown;
}

function connected() {
  const sent: Sent[] = [];
  let events!: TransportEvents;
  let opened = 0;
  const connection = new Connection((e) => {
    events = e;
    ++opened;
    return { send: (text) => sent.push(JSON.parse(text)), close: () => e.close() };
  });
  connection.start();
  events.open();
  return {
    connection,
    sent,
    answer: (id: number, body: object = {}) => events.message(JSON.stringify({ id, ok: true, ...body })),
    message: (text: string) => events.message(text),
    lose: (why?: string) => events.close(why),
    open: () => events.open(),
    opened: () => opened,
  };
}

const curve = (theta_i: number) =>
  ({ materials: [], kind: "polar", theta_i, phi_i: 0, theta_d: 0, phi_o: 180, points: 3 }) as const;
const turn = () => new Promise((resolve) => setImmediate(resolve));

test("of many requests in a slot only the first and the newest are sent", async () => {
  const { connection, sent, answer } = connected();
  const answers = [10, 20, 30, 40].map((t) => connection.latest("polar", "curves", { ...curve(t), materials: [] }));
  assert.deepEqual(sent.map((s) => s.theta_i), [10]);
  answer(sent[0].id, { n: 1 });
  await turn();
  assert.deepEqual(sent.map((s) => s.theta_i), [10, 40]);
  answer(sent[1].id, { n: 2 });
  const found = await Promise.all(answers);
  assert.deepEqual(found.map((a) => (a as unknown as { n: number } | undefined)?.n), [1, undefined, undefined, 2]);
  assert.equal(connection.outstanding, 0);
});

test("slots do not wait for each other", () => {
  const { connection, sent } = connected();
  connection.latest("a", "curves", { ...curve(1), materials: [] });
  connection.latest("b", "curves", { ...curve(2), materials: [] });
  assert.equal(sent.length, 2);
});

test("a failure frees its slot and carries line and column", async () => {
  const { connection, sent, message, answer } = connected();
  const first = connection.latest("c", "compile", { brdf: { name: "a", source: "" } });
  const second = connection.latest("c", "compile", { brdf: { name: "b", source: "" } });
  message(JSON.stringify({ id: sent[0].id, error: { message: "no", line: 12, column: 3 } }));
  await assert.rejects(first, (e: CoreError) => e.line === 12 && e.column === 3);
  await turn();
  answer(sent[1].id, {});
  assert.ok(await second);
});

test("progress comes before the last message and not after", async () => {
  const { connection, sent, answer } = connected();
  const seen: number[] = [];
  const task = connection.begin("fit", { measured: "m", models: [], metric: "log", starts: 1 }, (m) => seen.push(m.progress!));
  answer(sent[0].id, { progress: 0.25 });
  answer(sent[0].id, { progress: 1 });
  answer(sent[0].id, { results: [] });
  assert.deepEqual((await task.answer).results, []);
  assert.deepEqual(seen, [0.25, 1]);
});

test("cancel names the task, and only while it runs", async () => {
  const { connection, sent, answer } = connected();
  const task = connection.begin("watch", { files: ["a"] }, () => {});
  task.cancel();
  assert.deepEqual({ type: sent[1].type, of: sent[1].of }, { type: "cancel", of: task.id });
  answer(task.id, { progress: 0.5, cancelled: true });
  await task.answer;
  task.cancel();
  assert.equal(sent.length, 2);
});

test("what was under way fails when the connection is lost, and a new one is made", async () => {
  const { connection, lose, open, opened } = connected();
  const generation = connection.generation.value;
  const running = connection.latest("a", "curves", { ...curve(1), materials: [] });
  const waiting = connection.latest("a", "curves", { ...curve(2), materials: [] });
  lose();
  await assert.rejects(running, ConnectionLost);
  assert.equal(await waiting, undefined);
  await assert.rejects(connection.ask("hello", {}), ConnectionLost);
  await new Promise((resolve) => setTimeout(resolve, 400));
  assert.equal(opened(), 2);
  open();
  assert.equal(connection.generation.value, generation + 1);
});

test("a frame that cannot be read is told and does no harm", () => {
  const { connection, message } = connected();
  const problems: string[] = [];
  connection.onProblem = (text) => problems.push(text);
  message("{");
  message(JSON.stringify({ id: 999, ok: true }));
  assert.equal(problems.length, 1);
});

test("what makes a newer request of its slot wait for seconds is cancelled", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] } as never);
  const { connection, sent, answer } = connected();
  const first = connection.latest("polar", "curves", { ...curve(10), materials: [] });
  context.mock.timers.tick(60000); // nobody waits for it
  assert.equal(sent.length, 1);
  const second = connection.latest("polar", "curves", { ...curve(20), materials: [] });
  context.mock.timers.tick(1000);
  assert.equal(sent.length, 1);
  context.mock.timers.tick(1500);
  assert.deepEqual([sent[1].type, sent[1].of], ["cancel", sent[0].id]);
  answer(sent[0].id, { cancelled: true });
  assert.equal(await first, undefined);
  await turn();
  assert.equal(sent[2].theta_i, 20);
  context.mock.timers.tick(60000);
  assert.equal(sent.length, 3);
  answer(sent[2].id);
  assert.ok(await second);
});

test("a message larger than the core takes is not sent, and says so", async () => {
  const { connection, sent, answer } = connected();
  const write = (text: string) => connection.ask("write", { file: "a.brdf", text });
  await assert.rejects(write("x".repeat(65 * 2 ** 20)), (e: CoreError) => /66 MiB.* 64/.test(e.message));
  await assert.rejects(write("\u20ac".repeat(22 * 2 ** 20)), CoreError); // bytes count, not letters
  assert.equal(sent.length, 0);
  assert.equal(connection.outstanding, 0);
  const small = write("x".repeat(2 ** 20));
  answer(sent[0].id);
  assert.ok(await small);
});

test("why the core closed the connection is shown", async () => {
  const { connection, lose, open } = connected();
  const problems: string[] = [];
  connection.onProblem = (message) => problems.push(message);
  lose("a message was too large");
  open();
  lose();
  assert.deepEqual(problems, ["the core closed the connection: a message was too large"]);
});
