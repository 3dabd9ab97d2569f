/** What takes longer than a frame is asked of a worker (worker.mjs). */

/** Asks the worker, which may be busy with something older that nobody waits for any more. */
export class Background {
  /** Gets what is known so far of a long task. */
  progress = null;

  constructor(bytes) {
    const scripts = ["core-js", "worker-js"].map((id) => document.getElementById(id).textContent);
    this.worker = new Worker(URL.createObjectURL(new Blob(scripts, { type: "text/javascript" })));
    this.worker.postMessage({ bytes: bytes.slice(0) });
    this.waiting = new Map();
    this.last = 0;
    this.worker.onmessage = ({ data: told }) => {
      if (told.partial) return this.progress?.(told.partial);
      const { resolve, reject } = this.waiting.get(told.id) ?? {};
      this.waiting.delete(told.id);
      return told.failure ? reject?.(new Error(told.failure)) : resolve?.(told.answer);
    };
    this.worker.onerror = (event) => {
      const reason = new Error(event.message || "the browser starts no worker");
      for (const { reject } of this.waiting.values()) reject(reason);
      this.waiting.clear();
    };
  }
  ask(task, given, more = {}) {
    const id = ++this.last;
    this.worker.postMessage({ id, task, given, ...more });
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }
}
