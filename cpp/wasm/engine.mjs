/**
 * Compiles a module of the core for the engine that it runs on, and gives it what it imports.
 *
 * The core asks for a b + c, rounded once, by calls of its function `pendcore_fma`, which computes
 * it from sums and products. WebAssembly also has an instruction for it, f64x2.relaxed_madd, but an
 * engine may round that once or twice. Where it rounds once, `fastest` puts the instruction in the
 * place of the calls: the results are the same, and come more than twice as fast.
 */

const MAGIC = [0x00, 0x61, 0x73, 0x6d, 0x01, 0x00, 0x00, 0x00];
const CALL = 0x10;
/** f64x2.relaxed_madd, and three nops: as long as a call whose function's number has five bytes. */
const INSTRUCTION = [0xfd, 0x87, 0x02, 0x01, 0x01, 0x01];

/** (func (param $a f64) (param $b f64) (param $c f64) (result f64)) by relaxed_madd on two lanes. */
// biome-ignore format: a row is a section
const PROBE = Uint8Array.from([
  ...MAGIC,
  1, 8, 1, 0x60, 3, 0x7c, 0x7c, 0x7c, 1, 0x7c, // a type
  3, 2, 1, 0, // a function of it
  7, 5, 1, 1, 0x66, 0, 0, // exported as "f"
  10, 22, 1, 20, 0, // its code: splat a, b and c, fuse them, take a lane
  0x20, 0, 0xfd, 0x14, 0x20, 1, 0xfd, 0x14, 0x20, 2, 0xfd, 0x14,
  0xfd, 0x87, 0x02, 0xfd, 0x21, 0, 0x0b,
]);

/** Whether this engine has an instruction for a b + c that rounds once. */
export function fuses() {
  if (!WebAssembly.validate(PROBE)) return false;
  /** @type {any} */
  const { f } = new WebAssembly.Instance(new WebAssembly.Module(PROBE)).exports;
  const tiny = 2 ** -30;
  return f(1 + tiny, 1 - tiny, -1) === -(tiny ** 2) && f(3, 1 / 3, -1) === -(2 ** -54);
}

/**
 * The module's bytes with the instruction in the place of all calls of `pendcore_fma`.
 *
 * The number of that function is the name that an instance of the module gives it, by the JavaScript
 * interface of WebAssembly. The linker writes a function's number in five bytes, the last of them 0,
 * so a call has six. That these six bytes stand elsewhere by chance has a probability of 1e-8 in a
 * module of this size.
 */
export async function withInstructions(given) {
  const { instance } = await WebAssembly.instantiate(given, imports({}));
  /** @type {any} */
  const { pendcore_fma } = instance.exports;
  if (!pendcore_fma) throw new Error("this is not a module of pendcore: it has no pendcore_fma");
  let number = Number(pendcore_fma.name);
  if (!Number.isInteger(number)) return { bytes: given, calls: 0 }; // the calls do as well
  const call = [CALL];
  for (let i = 0; i < 5; ++i, number >>>= 7) call.push((number & 0x7f) | (i < 4 ? 0x80 : 0));
  const bytes = Uint8Array.from(given);
  let calls = 0;
  for (let at = bytes.indexOf(CALL); at >= 0; at = bytes.indexOf(CALL, at + 1)) {
    if (!call.every((byte, i) => bytes[at + i] === byte)) continue;
    bytes.set(INSTRUCTION, at);
    ++calls;
  }
  return { bytes, calls };
}

/** The bytes of the module that is fastest on this engine. */
export async function fastest(bytes) {
  return fuses() ? (await withInstructions(bytes)).bytes : bytes;
}

/** Thrown where the core throws: the message is the core's. */
export class PendcoreError extends Error {
  name = "PendcoreError";
}

/** Numbers of WASI's errors. */
const SUCCESS = 0;
const BAD_FILE = 8;

/**
 * What a module imports: its errors, and of WASI a clock, arguments and lines of text.
 *
 * `host.memory` is the module's memory, to be set once it is there; `host.print(line)` takes what a
 * program prints; `host.exit(code)` ends it.
 */
export function imports(host) {
  const view = () => new DataView(host.memory.buffer);
  const bytesAt = (at, size) => new Uint8Array(host.memory.buffer, at, size);
  const words = (host.arguments ?? []).map((word) => new TextEncoder().encode(`${word}\0`));
  const lines = { 1: "", 2: "" };

  function write(file, pieces, count, written) {
    if (!(file in lines)) return BAD_FILE;
    let size = 0;
    for (let i = 0; i < count; ++i) {
      const length = view().getUint32(pieces + 8 * i + 4, true);
      lines[file] += new TextDecoder().decode(
        bytesAt(view().getUint32(pieces + 8 * i, true), length),
      );
      size += length;
    }
    const whole = lines[file].split("\n");
    lines[file] = whole.pop(); // the beginning of a line that has no end yet
    for (const line of whole) host.print?.(line, file);
    view().setUint32(written, size, true);
    return SUCCESS;
  }

  function putWords(pointers, text) {
    for (const word of words) {
      view().setUint32(pointers, text, true);
      bytesAt(text, word.length).set(word);
      pointers += 4;
      text += word.length;
    }
    return SUCCESS;
  }

  function putTwo(first, second, count, size) {
    view().setUint32(first, count, true);
    view().setUint32(second, size, true);
    return SUCCESS;
  }

  return {
    pendcore: {
      thrown(message, size) {
        throw new PendcoreError(new TextDecoder().decode(bytesAt(message, size)));
      },
    },
    wasi_snapshot_preview1: {
      clock_time_get(_clock, _precision, at) {
        const now = BigInt(Math.round(performance.now() * 1000)) * 1000n;
        view().setBigUint64(at, now, true);
        return SUCCESS;
      },
      args_sizes_get: (count, size) =>
        putTwo(
          count,
          size,
          words.length,
          words.reduce((sum, word) => sum + word.length, 0),
        ),
      args_get: putWords,
      environ_sizes_get: (count, size) => putTwo(count, size, 0, 0),
      environ_get: () => SUCCESS,
      fd_write: write,
      fd_close: () => BAD_FILE,
      fd_seek: () => BAD_FILE,
      fd_read: () => BAD_FILE,
      fd_fdstat_get: () => BAD_FILE,
      proc_exit(code) {
        host.exit?.(code);
        throw new PendcoreError(`the program ended with exit status ${code}`);
      },
    },
  };
}
