/** What takes longer than a frame is asked of a worker (worker.mjs). */

/** Asks the worker, which may be busy with something older that nobody waits for any more. */
export class Background {
  /** Gets what is known so far of a long task. */
  progress = null;

  constructor(bytes) {
    const scripts = ["core-js", "worker-js"].map((id) => document.getElementById(id).textContent);
    this.worker = new Worker(URL.createObjectURL(new Blob(scripts, { type: "text/javascript" })));
    this.worker.postMessage({ bytes });
    /** Who waits for an answer: the worker answers in the order in which it was asked. */
    this.waiting = [];
    this.worker.onmessage = ({ data: { partial, failure, answer } }) => {
      if (partial) return this.progress?.(partial);
      const { resolve, reject } = this.waiting.shift();
      return failure ? reject(new Error(failure)) : resolve(answer);
    };
    this.worker.onerror = (event) => {
      const reason = new Error(event.message || "the browser starts no worker");
      for (const { reject } of this.waiting.splice(0)) reject(reason);
    };
  }
  ask(task, given, more) {
    this.worker.postMessage({ task, given, ...more });
    return new Promise((resolve, reject) => this.waiting.push({ resolve, reject }));
  }
}
