// The page that 'rosefusion run' and 'export' write: model, path, timeline. bundle.sh makes one file of it and three.js.
import {
  BufferAttribute, BufferGeometry, Color, DirectionalLight, HemisphereLight, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Quaternion, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

const by = (id) => document.getElementById(id);
const data = JSON.parse(by('data').textContent);
const frames = data.frames; // [seconds, status, reason, x, y, z, qx, qy, qz, qw]; without a pose the first three alone
const STATUS = {
  tracked: '#2da44e', uncertain: '#d4a017', relocalised: '#3f83f8', lost: '#d1242f', skipped: '#8b949e',
};

// Speeds, from the frame before that has a pose.
const places = frames.map((f) => (f.length > 3 ? new Vector3(f[3], f[4], f[5]) : null));
const turns = frames.map((f) => (f.length > 3 ? new Quaternion(f[6], f[7], f[8], f[9]) : null));
const speeds = frames.map(() => null);
const spins = frames.map(() => null);
let last = -1;
frames.forEach((f, i) => {
  if (!places[i]) return;
  if (last >= 0 && f[0] > frames[last][0]) {
    const seconds = f[0] - frames[last][0];
    speeds[i] = places[i].distanceTo(places[last]) / seconds;
    spins[i] = turns[i].angleTo(turns[last]) / seconds;
  }
  last = i;
});
const sorted = speeds.filter((s) => s !== null).sort((a, b) => a - b);
const fastest = sorted.length ? Math.max(sorted[Math.floor(0.98 * (sorted.length - 1))], 1e-3) : 1;

/** Blue for rest, green, yellow, red for the fastest. */
function shade(speed) {
  const share = Math.min((speed ?? 0) / fastest, 1);
  return new Color().setHSL((1 - share) * 0.62, 0.85, 0.5);
}

async function unpack() {
  const text = by('model').textContent.trim();
  if (!text) return null;
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = await new Response(stream).arrayBuffer();
  const {vertices, triangles, low, step, coloured} = data.model;
  const steps = new Uint16Array(bytes, 0, 3 * vertices);
  const positions = new Float32Array(3 * vertices);
  for (let i = 0; i < positions.length; i++) positions[i] = low[i % 3] + step * steps[i];
  let at = 6 * vertices;
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  if (coloured) {
    const linear = new Float32Array(256);
    for (let i = 0; i < 256; i++) linear[i] = new Color().setRGB(i / 255, 0, 0, 'srgb').r;
    const raw = new Uint8Array(bytes, at, 3 * vertices);
    geometry.setAttribute('color', new BufferAttribute(Float32Array.from(raw, (c) => linear[c]), 3));
    at += 3 * vertices;
  }
  at = Math.ceil(at / 4) * 4;
  const indices = new Uint32Array(bytes.slice(at, at + 12 * triangles)); // each less the one before
  for (let i = 1; i < indices.length; i++) indices[i] += indices[i - 1];
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  return geometry;
}

async function start() {
  const canvas = by('view');
  const renderer = new WebGLRenderer({canvas, antialias: true});
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  const scene = new Scene();
  const geometry = await unpack();
  by('wait').hidden = true;
  let model = null;
  if (geometry) {
    const coloured = geometry.hasAttribute('color');
    model = new Mesh(geometry, coloured ? new MeshBasicMaterial({vertexColors: true}) : new MeshLambertMaterial({color: 0xb8bec9}));
    scene.add(model);
    const sky = new HemisphereLight(0xffffff, 0x707784, 2.2);
    const sun = new DirectionalLight(0xffffff, 1.4);
    sun.position.set(1, 2, 1.5);
    scene.add(sky, sun);
  }
  const sphere = geometry ? geometry.boundingSphere : null;
  const centre = sphere ? sphere.center.clone() : places.find((p) => p)?.clone() ?? new Vector3();
  const radius = sphere ? sphere.radius : 2;
  const eye = new PerspectiveCamera(50, 1, radius / 500, radius * 20);
  const controls = new OrbitControls(eye, canvas);
  controls.enableDamping = false;

  // The path, broken where the camera was lost.
  const corners = [], colours = [];
  let before = -1;
  places.forEach((p, i) => {
    if (!p) { before = -1; return; }
    if (before >= 0) {
      const c = shade(speeds[i]);
      for (const q of [places[before], p]) { corners.push(q.x, q.y, q.z); colours.push(c.r, c.g, c.b); }
    }
    before = i;
  });
  const pathGeometry = new BufferGeometry();
  pathGeometry.setAttribute('position', new BufferAttribute(new Float32Array(corners), 3));
  pathGeometry.setAttribute('color', new BufferAttribute(new Float32Array(colours), 3));
  scene.add(new LineSegments(pathGeometry, new LineBasicMaterial({vertexColors: true})));

  // The camera as a small pyramid.
  const size = Math.max(0.05, Math.min(0.3, radius / 15));
  const h = size * Math.tan((data.fov * Math.PI) / 360), w = h * data.aspect;
  const tips = [[-w, -h], [w, -h], [w, h], [-w, h]].map(([x, y]) => [x, y, size]);
  const edges = [];
  tips.forEach((tip, i) => edges.push(0, 0, 0, ...tip, ...tip, ...tips[(i + 1) % 4]));
  edges.push(-w / 2, -h, size, 0, -1.5 * h, size, 0, -1.5 * h, size, w / 2, -h, size); // what is up
  const pyramid = new BufferGeometry();
  pyramid.setAttribute('position', new BufferAttribute(new Float32Array(edges), 3));
  const recorder = new LineSegments(pyramid, new LineBasicMaterial({color: 0xffffff}));
  recorder.matrixAutoUpdate = false;
  scene.add(recorder);

  let dirty = true, mode = 'orbit', current = 0, playing = false, clock = 0;
  const ask = () => { dirty = true; };
  controls.addEventListener('change', ask);

  function home() {
    // From obliquely above, on the side that the first cameras stand on.
    const stand = places.find((p) => p);
    const away = new Vector3(0, 0, 1);
    if (stand && stand.distanceTo(centre) > radius / 10) away.subVectors(stand, centre).setY(0).normalize();
    if (away.lengthSq() < 0.5) away.set(0, 0, 1);
    controls.target.copy(centre).y -= 0.14 * radius; // the timeline covers the picture's foot
    const far = 0.95 * radius / Math.sin((Math.min(eye.fov, eye.fov * eye.aspect) * Math.PI) / 360);
    eye.position.copy(controls.target).addScaledVector(away, far * 0.72).add(new Vector3(0, far * 0.69, 0));
    eye.up.set(0, 1, 0);
    controls.update();
    ask();
  }

  const turnRound = new Matrix4().makeScale(1, -1, -1); // our cameras look along z with y down, WebGL's along -z with y up
  const lastPlace = (i) => { while (i > 0 && !places[i]) i--; return places[i] ? i : places.findIndex((p) => p); };
  function stand() {
    const i = lastPlace(current);
    if (i < 0) { recorder.visible = false; return; }
    recorder.matrix.compose(places[i], turns[i], new Vector3(1, 1, 1));
    recorder.material.color.set(STATUS[frames[current][1]] ?? '#888');
    recorder.visible = mode === 'orbit';
    if (mode === 'first') {
      new Matrix4().copy(recorder.matrix).multiply(turnRound).decompose(eye.position, eye.quaternion, new Vector3());
    }
    ask();
  }
  function show(i) {
    current = Math.max(0, Math.min(frames.length - 1, i));
    if (!frames.length) return;
    const f = frames[current];
    by('slider').value = String(current);
    by('slider').setAttribute('aria-valuetext', `${(f[0] - frames[0][0]).toFixed(2)} s, ${f[1]}`);
    by('clock').textContent = `${(f[0] - frames[0][0]).toFixed(2)} s, frame ${data.numbers[current]}`;
    by('status').textContent = f[1];
    by('status').style.color = STATUS[f[1]] ?? '';
    const v = speeds[current];
    by('speed').textContent = v === null ? '' : `${v.toFixed(2)} m/s, ${((spins[current] * 180) / Math.PI).toFixed(0)} deg/s`;
    by('reason').textContent = f[1] === 'tracked' ? '' : data.reasons[f[2]] ?? '';
    stand();
  }
  function setMode(next) {
    if (mode === 'first' && next === 'orbit') { mode = next; eye.fov = 50; home(); }
    mode = next;
    controls.enabled = mode === 'orbit';
    eye.fov = mode === 'first' ? data.fov : 50;
    by('orbit').setAttribute('aria-pressed', String(mode === 'orbit'));
    by('first').setAttribute('aria-pressed', String(mode === 'first'));
    resize();
    stand();
  }
  function play(on) {
    playing = on && frames.length > 1;
    if (playing && current === frames.length - 1) show(0);
    clock = performance.now() - 1000 * (frames.length ? frames[current][0] - frames[0][0] : 0);
    by('play').innerHTML = playing ? '&#10074;&#10074;' : '&#9654;';
    by('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
    ask();
  }

  // Measuring: two clicks on the surface.
  let measuring = false, points = [];
  const rayCaster = new Raycaster();
  const ruler = new Line(new BufferGeometry(), new LineBasicMaterial({color: 0xff3b8d, depthTest: false}));
  ruler.renderOrder = 1;
  ruler.frustumCulled = false;
  scene.add(ruler);
  function hit(event) {
    if (!model) return null;
    const box = canvas.getBoundingClientRect();
    rayCaster.setFromCamera(new Vector2(((event.clientX - box.left) / box.width) * 2 - 1,
                                        1 - ((event.clientY - box.top) / box.height) * 2), eye);
    return rayCaster.intersectObject(model)[0]?.point ?? null;
  }
  function setPoints(next) {
    points = next;
    // One point is drawn as a small cross, two as a line.
    const arm = radius / 100, at = points[0];
    const cross = at ? [new Vector3(at.x - arm, at.y, at.z), new Vector3(at.x + arm, at.y, at.z), at,
                        new Vector3(at.x, at.y + arm, at.z), new Vector3(at.x, at.y - arm, at.z)] : [];
    ruler.geometry.dispose();
    ruler.geometry = new BufferGeometry().setFromPoints(points.length === 2 ? points : cross);
    ask();
  }
  function setMeasuring(on) {
    measuring = on;
    by('measure').setAttribute('aria-pressed', String(on));
    canvas.style.cursor = on ? 'crosshair' : '';
    if (!on) setPoints([]);
  }
  let pressed = null;
  canvas.addEventListener('pointerdown', (e) => { pressed = [e.clientX, e.clientY]; });
  canvas.addEventListener('pointerup', (e) => {
    const still = pressed && Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) < 6;
    if (!measuring || !still) return;
    const point = hit(e);
    if (point) setPoints(points.length === 1 ? [points[0], point] : [point]);
  });
  canvas.addEventListener('dblclick', (e) => {
    const point = measuring || mode !== 'orbit' ? null : hit(e);
    if (point) { controls.target.copy(point); controls.update(); ask(); }
  });
  function label() {
    const box = by('measured');
    box.hidden = points.length !== 2;
    if (box.hidden) return;
    const middle = points[0].clone().add(points[1]).multiplyScalar(0.5).project(eye);
    box.hidden = middle.z > 1;
    box.style.left = `${((middle.x + 1) / 2) * innerWidth}px`;
    box.style.top = `${((1 - middle.y) / 2) * innerHeight}px`;
    const length = points[0].distanceTo(points[1]);
    box.textContent = length < 1 ? `${(100 * length).toFixed(1)} cm` : `${length.toFixed(3)} m`;
  }

  function setTheme(dark) {
    document.documentElement.classList.toggle('dark', dark);
    by('theme').setAttribute('aria-pressed', String(dark));
    scene.background = new Color(dark ? '#14161a' : '#f4f5f7');
    ask();
  }
  function resize() {
    renderer.setSize(innerWidth, innerHeight, false);
    eye.aspect = innerWidth / innerHeight;
    eye.updateProjectionMatrix();
    const strip = by('strip');
    strip.width = strip.clientWidth || 300;
    const pen = strip.getContext('2d');
    for (let x = 0; x < strip.width; x++) {
      // What is worst among the frames under one pixel.
      const a = Math.floor((x / strip.width) * frames.length);
      const b = Math.max(a + 1, Math.floor(((x + 1) / strip.width) * frames.length));
      const all = frames.slice(a, b).map((f) => f[1]);
      const worst = ['lost', 'skipped', 'relocalised', 'uncertain', 'tracked'].find((s) => all.includes(s));
      pen.fillStyle = STATUS[worst] ?? '#888';
      pen.fillRect(x, 0, 1, 8);
    }
    ask();
  }

  by('slider').max = String(Math.max(0, frames.length - 1));
  by('slider').addEventListener('input', (e) => { play(false); show(Number(e.target.value)); });
  by('play').addEventListener('click', () => play(!playing));
  by('orbit').addEventListener('click', () => setMode('orbit'));
  by('first').addEventListener('click', () => setMode('first'));
  by('measure').addEventListener('click', () => setMeasuring(!measuring));
  by('theme').addEventListener('click', () => setTheme(!document.documentElement.classList.contains('dark')));
  by('reset').addEventListener('click', () => { setMode('orbit'); setPoints([]); home(); });
  addEventListener('resize', resize);
  addEventListener('keydown', (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const onButton = e.target instanceof HTMLButtonElement;
    const step = e.shiftKey ? 10 : 1;
    const action = {
      ' ': onButton ? null : () => play(!playing), ArrowLeft: () => { play(false); show(current - step); },
      ArrowRight: () => { play(false); show(current + step); }, Home: () => show(0), End: () => show(frames.length - 1),
      o: () => setMode('orbit'), f: () => setMode('first'), m: () => setMeasuring(!measuring), d: () => by('theme').click(),
      r: () => by('reset').click(), Escape: () => setMeasuring(false),
    }[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  });

  by('legend').querySelector('i').style.background =
    `linear-gradient(90deg, ${[0, 0.25, 0.5, 0.75, 1].map((s) => `#${shade(s * fastest).getHexString()}`).join(',')})`;
  by('fastest').textContent = `${fastest.toFixed(1)} m/s`;
  const counted = Object.keys(STATUS).map((s) => [s, frames.filter((f) => f[1] === s).length]).filter(([, n]) => n);
  by('figures').textContent = `${frames.length} frames: ${counted.map(([s, n]) => `${n} ${s}`).join(', ')}` +
    (data.model ? ` \u00b7 ${data.model.triangles.toLocaleString('en')} triangles` : ' \u00b7 no surface');
  by('time').hidden = frames.length === 0;

  setTheme(matchMedia('(prefers-color-scheme: dark)').matches);
  resize();
  home();
  show(0);
  renderer.setAnimationLoop(() => {
    if (playing) {
      const t = (performance.now() - clock) / 1000 + frames[0][0];
      let i = current;
      while (i + 1 < frames.length && frames[i + 1][0] <= t) i++;
      if (i !== current) show(i);
      if (i === frames.length - 1) play(false);
    }
    if (!dirty) return;
    dirty = false;
    renderer.render(scene, eye);
    label();
    document.documentElement.dataset.drawn = '1';
  });
}

start().catch((error) => {
  by('wait').hidden = false;
  by('wait').textContent = `The model cannot be shown: ${error.message}. This page needs WebGL 2 and a browser of 2023 or later.`;
  console.error(error);
});
