// Requests to the core over a transport that may vanish and come back. Of requests in one slot at most one is
// under way and one waits, so that a dragged slider never queues up.

import { signal } from "@preact/signals";
import { type Answer, type Message, type RequestType, type Requests, decode } from "./protocol";

export interface Transport {
  send(text: string): void;
  close(): void;
}

export interface TransportEvents {
  open(): void;
  message(data: string | ArrayBuffer): void;
  /// @param why  as far as there is more to say than that it is gone
  close(why?: string): void;
}

export type OpenTransport = (events: TransportEvents) => Transport;

/// What a request failed with; `line` and `column` where the core knows them.
export class CoreError extends Error {
  constructor(
    message: string,
    readonly line?: number,
    readonly column?: number,
  ) {
    super(message);
  }
}

export class ConnectionLost extends Error {
  constructor() {
    super("the connection to the core was lost");
  }
}

/// A long request: its answer, its progress messages, its end on demand.
export interface Task<T extends RequestType> {
  id: number;
  answer: Promise<Answer<T>>;
  cancel(): void;
}

interface Pending {
  resolve(message: Message): void;
  reject(error: Error): void;
  progress?(message: Message): void;
}

interface Slot {
  running: boolean;
  /// Ends the request under way, which a newer one waits for.
  cancel?: () => void;
  impatience?: ReturnType<typeof setTimeout>;
  next?: () => void;
  drop?: () => void;
}

/// Milliseconds that a request may make a newer one of its slot wait. What is computed in less is shown, so that a
/// dragged slider shows something on the way.
const patience = 2000;

/// Bytes that the core takes at once: ServerOptions::max_message.
const largestMessage = 64 * 2 ** 20;

export class Connection {
  readonly status = signal<"connecting" | "open" | "lost">("connecting");
  /// Counts the connections made: whoever depends on it asks anew after a reconnection.
  readonly generation = signal(0);
  /// Messages that answer no request, such as a frame that cannot be read.
  onProblem: (message: string) => void = () => {};

  private transport?: Transport;
  private pending = new Map<number, Pending>();
  private slots = new Map<string, Slot>();
  private lastId = 0;
  private delay = 250;
  private timer?: ReturnType<typeof setTimeout>;

  constructor(private readonly open: OpenTransport) {}

  start(): void {
    this.transport = this.open({
      open: () => {
        this.delay = 250;
        this.status.value = "open";
        this.generation.value++;
      },
      message: (data) => this.receive(data),
      close: (why) => this.lost(why),
    });
  }

  /// Requests under way or waiting; long tasks are counted too.
  get outstanding(): number {
    let waiting = 0;
    for (const slot of this.slots.values()) if (slot.next) waiting++;
    return this.pending.size + waiting;
  }

  ask<T extends RequestType>(type: T, body: Requests[T], slot?: string): Promise<Answer<T>> {
    return this.send(type, body, slot).answer;
  }

  begin<T extends RequestType>(type: T, body: Requests[T], progress: (message: Answer<T>) => void): Task<T> {
    return this.send(type, body, undefined, progress as (message: Message) => void);
  }

  /// The newest request of a slot wins: one that was never sent resolves to undefined.
  latest<T extends RequestType>(slot: string, type: T, body: Requests[T]): Promise<Answer<T> | undefined> {
    let state = this.slots.get(slot);
    if (!state) this.slots.set(slot, (state = { running: false }));
    const own = state;
    return new Promise((resolve, reject) => {
      const run = () => {
        own.running = true;
        own.next = own.drop = undefined;
        const after = () => {
          own.running = false;
          clearTimeout(own.impatience);
          own.impatience = undefined;
          own.next?.();
        };
        const task = this.send(type, body, slot);
        own.cancel = task.cancel;
        task.answer.then(
          (answer) => {
            resolve(answer.cancelled ? undefined : answer);
            after();
          },
          (error) => {
            reject(error);
            after();
          },
        );
      };
      if (!own.running) return run();
      own.drop?.();
      own.impatience ??= setTimeout(() => own.cancel?.(), patience);
      own.next = run;
      own.drop = () => resolve(undefined);
    });
  }

  private send<T extends RequestType>(
    type: T,
    body: Requests[T],
    slot?: string,
    progress?: (message: Message) => void,
  ): Task<T> {
    const id = ++this.lastId;
    const answer = new Promise<Message>((resolve, reject) => {
      if (this.status.value !== "open") return reject(new ConnectionLost());
      const text = JSON.stringify({ id, type, ...(slot ? { slot } : {}), ...body });
      const bytes = text.length < largestMessage / 3 ? text.length : new TextEncoder().encode(text).length;
      if (bytes > largestMessage)
        return reject(new CoreError(`a message of ${Math.ceil(bytes / 2 ** 20)} MiB is not sent: the core takes ${largestMessage / 2 ** 20}`));
      this.pending.set(id, { resolve, reject, progress });
      this.transport!.send(text);
    }) as Promise<Answer<T>>;
    const cancel = () => {
      if (this.pending.has(id) && this.status.value === "open")
        this.transport!.send(JSON.stringify({ id: ++this.lastId, type: "cancel", of: id }));
    };
    return { id, answer, cancel };
  }

  private receive(data: string | ArrayBuffer): void {
    let message: Message;
    try {
      message = decode(data);
    } catch (error) {
      this.onProblem(`an answer of the core cannot be read: ${(error as Error).message}`);
      return;
    }
    const pending = this.pending.get(message.id);
    if (!pending) {
      if (message.error && !message.id) this.onProblem(message.error.message);
      return;
    }
    if (message.progress !== undefined && pending.progress && !message.error && !isLast(message)) {
      pending.progress(message);
      return;
    }
    this.pending.delete(message.id);
    if (message.error) {
      const { message: text, line, column } = message.error;
      pending.reject(new CoreError(text, line, column));
    } else {
      pending.resolve(message);
    }
  }

  private lost(why?: string): void {
    if (why && this.status.value === "open") this.onProblem(`the core closed the connection: ${why}`);
    this.status.value = "lost";
    const pending = [...this.pending.values()];
    this.pending.clear();
    for (const slot of this.slots.values()) {
      slot.drop?.();
      slot.next = slot.drop = undefined;
    }
    for (const { reject } of pending) reject(new ConnectionLost());
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.start(), this.delay);
    this.delay = Math.min(2 * this.delay, 4000);
  }
}

/// Progress messages carry `progress`; the last message of long work carries `ok` without it, or `cancelled`.
const isLast = (message: Message): boolean => message.progress === undefined || message.cancelled === true;

/// A WebSocket to the server that served the page, with the token of its address.
export const webSocketTransport: OpenTransport = (events) => {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const socket = new WebSocket(`${scheme}://${location.host}/ws?token=${encodeURIComponent(token())}`);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => events.open();
  socket.onmessage = (event) => events.message(event.data);
  socket.onclose = ({ code, reason }) => events.close(reason || closeCodes[code]);
  return socket;
};

/// What a server may close a WebSocket for beside that it ends. Source: RFC 6455, section 7.4.1.
const closeCodes: Record<number, string | undefined> = {
  1002: "a message broke the protocol",
  1003: "a message was of a kind that it does not take",
  1007: "a text was no UTF-8",
  1008: "a message broke its rules",
  1009: "a message was too large",
  1011: "it met a condition that it did not expect",
};

/// The token of this start: in the address, remembered for reloads of a shared one.
export const token = (): string => new URLSearchParams(location.search).get("token") ?? "";

/// Uploads bytes into the served folder and answers the name they have there.
export async function upload(name: string, bytes: Blob): Promise<string> {
  const query = `token=${encodeURIComponent(token())}&name=${encodeURIComponent(name)}`;
  const response = await fetch(`/upload?${query}`, { method: "POST", body: bytes });
  const text = await response.text();
  if (!response.ok) throw new Error(text || `upload of ${name}: ${response.status}`);
  try {
    return (JSON.parse(text) as { file?: string }).file ?? name;
  } catch {
    return name;
  }
}
