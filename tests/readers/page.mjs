// page.mjs FOLDER SCRIPT [PICTURE.png [WIDTH,HEIGHT]]: opens a page of ivory export --to web in Chromium, served from its folder, and prints
// what SCRIPT, the body of an async function of `page`, answers, with the browser's complaints and the time to the first
// frame. Through Chromium's debugging pipe: nothing but Node.js is needed.
import { spawn } from 'node:child_process';
import { createServer } from 'node:http';
import { readFile, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';

const [folder, script, picture, size = '320,240'] = process.argv.slice(2);
const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json' };
const server = createServer(async (request, response) => {
  const name = normalize(new URL(request.url, 'http://x').pathname);
  try {
    const body = await readFile(join(folder, name.endsWith('/') ? name + 'index.html' : name));
    response.writeHead(200, { 'content-type': types[extname(name) || '.html'] ?? 'application/octet-stream' });
    response.end(body);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));

const profile = await mkdtemp(join(tmpdir(), 'ivory-page-'));
const browser = spawn('chromium', ['--headless=new', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader', '--hide-scrollbars', `--window-size=${size}`, `--user-data-dir=${profile}`,
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--proxy-server=127.0.0.1:9',
  '--proxy-bypass-list=127.0.0.1', '--remote-debugging-pipe'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
const complaints = [];
const waiting = new Map();
let next = 0;
let left = '';
browser.stdio[4].setEncoding('utf8');
browser.stdio[4].on('data', (data) => {
  const parts = (left + data).split('\0');
  left = parts.pop();
  for (const part of parts) {
    const message = JSON.parse(part);
    if (message.id) {
      const { resolve, reject } = waiting.get(message.id);
      if (message.error) reject(new Error(message.error.message));
      else resolve(message.result);
    }
    if (message.method === 'Runtime.exceptionThrown')
      complaints.push(message.params.exceptionDetails.exception?.description ?? message.params.exceptionDetails.text);
    if (message.method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(message.params.type))
      complaints.push(message.params.args.map((a) => a.value ?? a.description).join(' '));
    if (message.method === 'Log.entryAdded' && message.params.entry.level === 'error')
      complaints.push(`${message.params.entry.text} ${message.params.entry.url ?? ''}`);
  }
});
const send = (method, params = {}, sessionId) => new Promise((resolve, reject) => {
  waiting.set(++next, { resolve, reject });
  browser.stdio[3].write(JSON.stringify({ id: next, method, params, sessionId }) + '\0');
});
const end = async (code) => {
  browser.kill('SIGKILL');
  server.close();
  await new Promise((resolve) => { browser.exitCode !== null || browser.signalCode !== null ? resolve() : browser.on('exit', resolve); });
  await rm(profile, { recursive: true, force: true, maxRetries: 5 });
  process.exit(code);
};
browser.on('error', (error) => { console.error(error.message); process.exit(1); });
setTimeout(() => { console.error('no answer in 120 s', complaints); end(1); }, 120000).unref();

const { targetId } = await send('Target.createTarget', { url: 'about:blank' });
const { sessionId } = await send('Target.attachToTarget', { targetId, flatten: true });
for (const domain of ['Runtime', 'Log', 'Page']) await send(domain + '.enable', {}, sessionId);
await send('Page.navigate', { url: `http://127.0.0.1:${server.address().port}/` }, sessionId);
const evaluate = async (expression) => {
  const result = await send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true }, sessionId);
  if (result.exceptionDetails) throw new Error(result.exceptionDetails.exception?.description ?? result.exceptionDetails.text);
  return result.result.value;
};
try {
  // The page's script may not have begun yet.
  const opened = `(async () => {
    while (!window.ivory) await new Promise((resolve) => setTimeout(resolve, 10));
    return await window.ivory; })()`;
  const firstFrameMs = await evaluate(`${opened}.then((page) => page.firstFrameMs)`);
  const answer = await evaluate(`${opened}.then(async (page) => { ${script} })`);
  if (picture) {
    // A frame that was asked for is drawn before the next but one.
    await evaluate('new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => r(0))))');
    const { data } = await send('Page.captureScreenshot', { format: 'png' }, sessionId);
    await writeFile(picture, Buffer.from(data, 'base64'));
  }
  console.log(JSON.stringify({ firstFrameMs, answer: answer ?? null, complaints }));
  await end(0);
} catch (error) {
  console.error(error.message, complaints);
  await end(1);
}
