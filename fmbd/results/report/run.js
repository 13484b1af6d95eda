// The page: controls of the player, and the plots that follow it.
const player = new Player(element("scene"), data.scene);
const LASTS = 8; // seconds that the whole run takes to play

function offer(select, choices, chosen) {
  for (const [text, value] of choices) select.add(new Option(text, value, value === chosen, value === chosen));
}

// 1, 2 or 5 times a power of ten.
function round(value) {
  const power = 10 ** Math.floor(Math.log10(value)), lead = value / power;
  return Number(((lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power).toPrecision(1));
}

const usual = round((player.duration - player.times[0]) / LASTS);
const speeds = [...new Set([0.1, 0.2, 0.5, 1, 2, 5, 10].map((factor) => round(factor * usual)))];
offer(element("speed"), speeds.map((speed) => [`${speed}×`, speed]), usual);
offer(element("deflection"), [1, 2, 5, 10, 20, 50, 100].map((scale) => [`${scale}×`, scale]), 1);
offer(element("trail"), [["none", ""], ...Object.keys(data.scene.tracks).map((name) => [name, name])], data.scene.trail ?? "");
element("exaggerate").hidden = !data.scene.items.some((item) => item.kind === "beam");

const slider = element("time");
slider.min = player.times[0];
slider.max = player.duration;

const overTime = makeGroup((time) => show(time));
const groups = drawCharts(overTime);

function show(time) {
  player.time = overTime.now = time;
  slider.value = time;
  element("clock").textContent = `${time.toFixed(Math.max(0, 3 - Math.floor(Math.log10(player.duration))))} s`;
  player.draw();
  overTime.draw();
}

let playing = null;

function play() {
  element("play").textContent = "❚❚";
  element("play").setAttribute("aria-label", "pause");
  if (player.time >= player.duration) show(player.times[0]);
  let last = performance.now();
  const step = (now) => {
    const time = player.time + (Number(element("speed").value) * (now - last)) / 1000;
    last = now;
    show(time > player.duration ? player.times[0] : Math.max(time, player.times[0]));
    playing = requestAnimationFrame(step);
  };
  playing = requestAnimationFrame(step);
}

function pause() {
  cancelAnimationFrame(playing);
  playing = null;
  element("play").textContent = "▶";
  element("play").setAttribute("aria-label", "play");
}

element("play").addEventListener("click", () => (playing === null ? play() : pause()));
slider.addEventListener("input", () => { pause(); show(Number(slider.value)); });
element("deflection").addEventListener("change", (event) => { player.exaggerate(Number(event.target.value)); player.draw(); });
element("trail").addEventListener("change", (event) => { player.trail = event.target.value; player.draw(); });
window.addEventListener("resize", () => { player.draw(); for (const group of groups) group.draw(); });
for (const group of groups) group.draw();
show(player.times[0]);
