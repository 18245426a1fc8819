"""The page around meshcat's viewer: title, legend, and a bar to play, pause and scrub. See viewer."""

from __future__ import annotations

import html
import json
from importlib.resources.abc import Traversable
from string import Template

from stepover.report.scene import Camera

PROGRAM = "dist/main.min.js", "LICENSE", "dist/main.min.js.LICENSE.txt"
PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<!-- Nothing is loaded: a browser that obeys this line opens no connection, whatever the code below asks for. -->
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:">
<title>$title</title>
<style>
  html, body { margin: 0; height: 100%; overflow: hidden; font: 14px/1.4 system-ui, sans-serif; color: #222; }
  #meshcat-pane { width: 100vw; height: 100vh; overflow: hidden; }
  #title { position: absolute; left: 14px; top: 10px; right: 270px; pointer-events: none; }
  #title h1 { font-size: 16px; font-weight: 600; margin: 0 0 2px; }
  #title span { margin-right: 12px; white-space: nowrap; }
  #title i { display: inline-block; width: 11px; height: 11px; margin-right: 5px; border-radius: 2px; }
  #bar { position: absolute; left: 14px; right: 14px; bottom: 12px; display: flex; gap: 10px; align-items: center; }
  #bar input { flex: 1; min-width: 60px; }
  #bar output { font-variant-numeric: tabular-nums; min-width: 5em; text-align: right; }
  #phase { min-width: 11em; white-space: nowrap; }
  #bar button { width: 5em; }
  .dg.main { display: none !important; }  /* the viewer's own controls: ours are below */
  #trouble { position: absolute; left: 14px; top: 40%; color: #b00; }
</style>
</head>
<body>
<div id="meshcat-pane"></div>
<div id="title"><h1>$title</h1>$legend</div>
<div id="bar">
  <button id="play">play</button>
  <input id="scrub" type="range" min="0" max="1" step="0.001" value="0" aria-label="time">
  <output id="phase"></output>
  <output id="clock"></output>
  <select id="speed" aria-label="speed">
    <option value="1">real time</option><option value="0.5">half</option>
    <option value="0.25">a quarter</option><option value="0.1">a tenth</option>
  </select>
</div>
<div id="trouble"></div>
<script>
  window.addEventListener("error", (event) => {
    document.getElementById("trouble").textContent = "This page cannot be shown: it needs WebGL. " + event.message;
  });
</script>
<script type="text/plain">$licences</script>
<script>$program</script>
<script>
const viewer = new MeshCat.Viewer(document.getElementById("meshcat-pane"));
for (const command of $commands)
  viewer.handle_command_bytearray(Uint8Array.from(atob(command), (letter) => letter.charCodeAt(0)));

const [play, scrub, phase, clock, speed] = ["play", "scrub", "phase", "clock", "speed"].map(
  (id) => document.getElementById(id));
const animator = viewer.animator;
scrub.max = animator.duration;
function seek(time) {
  animator.display_progress(time);
  animator.seek(time);
}
scrub.addEventListener("input", () => { animator.pause(); seek(Number(scrub.value)); });
play.addEventListener("click", () => animator.playing ? animator.pause() : animator.play());
speed.addEventListener("change", () => { animator.mixer.timeScale = Number(speed.value); });
const phases = $phases;
function follow() {
  play.textContent = animator.playing ? "pause" : "play";
  if (Number(scrub.value) !== animator.time) scrub.value = animator.time;
  phase.textContent = phases.findLast(([begins]) => animator.time >= begins - 1e-3)[1];
  clock.textContent = ($begin + animator.time).toFixed(2) + " s";
  requestAnimationFrame(follow);
}
animator.play();  // only what has been played once can be scrubbed
animator.pause();
seek($time);

const {lens, target, eye} = $camera;  // the viewer's axes: x ahead, y up, z to the right
const back = Math.max(1, 1.5 * window.innerHeight / window.innerWidth);  // in a narrow frame, further away
viewer.camera.fov = lens;
viewer.camera.position.set(...target.map((place, axis) => place + back * eye[axis]));
viewer.controls.target.set(...target);
follow();
</script>
</body>
</html>
""")


def compose(
    title: str,
    legend: dict[str, str],
    viewer: Traversable,
    commands: list[str],
    camera: Camera,
    phases: list[tuple[float, str]],
    begin: float,
    time: float,
) -> str:
    """The whole page.

    Args:
        title: title of the page.
        legend: meaning of each colour, by the colour.
        viewer: folder of meshcat's viewer. Its program and licences are copied into the page.
        commands: commands for the viewer, packed, in base64.
        camera: first camera position.
        phases: start of each phase, since the first sample [s], and its name.
        begin: time of the first sample [s].
        time: time shown when the page opens, since the first sample [s].
    """
    program, *licences = ((viewer / name).read_text(encoding="utf-8") for name in PROGRAM)
    colours = (f'<span><i style="background: {key}"></i>{html.escape(text)}</span>' for key, text in legend.items())
    places = {name: (x, z, -y) for name, (x, y, z) in (("target", camera.target), ("eye", camera.eye))}
    return PAGE.substitute(
        title=html.escape(title),
        legend="".join(colours),
        licences="\n".join(licences),
        program=program,
        commands=json.dumps(commands),
        camera=json.dumps({"lens": camera.lens, **places}),
        phases=json.dumps(phases),
        begin=json.dumps(begin),
        time=json.dumps(time),
    )
