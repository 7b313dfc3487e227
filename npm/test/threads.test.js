// Threads of WebAssembly when something goes wrong, and on pages that cannot have them.
import assert from 'node:assert/strict';
import test from 'node:test';
import { wasmBackend } from '../roughcast/lib/backend.wasm.js';
import { callThreads } from '../roughcast/lib/threads.js';

/** Returns bytes with their number before them; everything here is shorter than 128 bytes. */
const sized = (bytes) => [bytes.length, ...bytes];
const list = (...items) => [items.length, ...items.flat()];
const name = (text) => sized([...Buffer.from(text)]);
const section = (id, bytes) => [id, ...sized(bytes)];
const body = (...code) => sized([0, ...code, END]);
const [I32, END, UNREACHABLE, CONST, CALL, DROP, GET] = [0x7f, 0x0b, 0x00, 0x41, 0x10, 0x1a, 0x20];
/** Loads from the end of 4 GiB, where no memory is. */
const OUTSIDE = [CONST, 0x7c, 0x28, 0, 0, DROP];

/** The response of the module, and where it is. */
const [ANSWER, HEADER] = [32, [...Buffer.from('{"files":[],"done":true}')]];

/**
 * Makes a module with the imports and exports of the real one. Its call answers on one thread. With more, it starts a
 * thread and then waits for ever, as the thread pool waits for a thread that has work. `run` is the code of the thread.
 */
function waiting(...run) {
  const onOneThread = [GET, 2, CONST, 1, 0x46, 0x04, 0x40, CONST, ANSWER, 0x0f, END];
  const wait = [CONST, 0, CONST, 0, 0x42, 0x7f, 0xfe, 0x01, 2, 0];
  const code = list(
    body(CONST, 0x80, 0x80, 0x08),
    body(...onOneThread, CONST, 0, CALL, 0, ...wait, DROP, CONST, 0),
    body(),
    body(...run),
  );
  const variable = (isMutable, value) => [I32, isMutable, CONST, value, END];
  const [FUNCTION, GLOBAL] = [0, 3];
  const exported = (text, kind, index) => [...name(text), kind, index];
  return new WebAssembly.Module(
    Uint8Array.from([
      ...[0x00, 0x61, 0x73, 0x6d, 1, 0, 0, 0],
      ...section(1, list([0x60, 1, I32, 1, I32], [0x60, 3, I32, I32, I32, 1, I32], [0x60, 1, I32, 0])),
      // The memory has 256 to 65536 pages and is shared.
      ...section(
        2,
        list(
          [...name('env'), ...name('memory'), 2, 3, 0x80, 0x02, 0x80, 0x80, 0x04],
          [...name('roughcast'), ...name('spawn'), 0, 2],
        ),
      ),
      ...section(3, list(0, 1, 2, 2)),
      ...section(6, list(variable(1, 0), variable(0, 16), variable(0, 16))),
      ...section(
        7,
        list(
          exported('allocate', FUNCTION, 1),
          exported('call', FUNCTION, 2),
          exported('__wasm_init_tls', FUNCTION, 3),
          exported('run_thread', FUNCTION, 4),
          exported('__stack_pointer', GLOBAL, 0),
          exported('__tls_size', GLOBAL, 1),
          exported('__tls_align', GLOBAL, 2),
        ),
      ),
      ...section(10, code),
      ...section(11, list([0, CONST, ANSWER, END, ...sized([0, 0, 0, 0, HEADER.length, 0, 0, 0, ...HEADER])])),
    ]),
  );
}

test('a thread that fails ends the call that waits for it', async () => {
  const call = callThreads(waiting(UNREACHABLE), { command: 'bake' }, [], 2);
  await assert.rejects(call, /the WebAssembly module failed; please report this: unreachable/);
});

test('a call ends on one thread if the memory of the others is out of date', async () => {
  const response = await callThreads(waiting(...OUTSIDE), { command: 'bake' }, [], 2);
  assert.deepEqual(response, { header: { done: true }, files: [] });
});

test('without shared memory a bake has one thread, whatever is asked for', async () => {
  const loaded = [];
  const load = async (file) => {
    loaded.push(file);
    throw new Error('no module');
  };
  for (const [canShare, threads] of Object.entries({ false: 4, true: 1 })) {
    const { listFiles } = wasmBackend({ load, canShare: canShare === 'true', processors: 8 });
    await assert.rejects(listFiles(new Uint8Array(1), threads), /no module/);
  }
  assert.deepEqual(loaded, ['roughcast.wasm', 'roughcast.wasm']);
  const shared = wasmBackend({ load, canShare: true, processors: 8 });
  // A load that failed is tried again.
  for (let i = 0; i < 2; i++) await assert.rejects(shared.listFiles(new Uint8Array(1)), /no module/);
  assert.deepEqual(loaded.slice(2), ['roughcast.threads.wasm', 'roughcast.threads.wasm']);
});
