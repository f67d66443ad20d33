# SPDX-License-Identifier: Apache-2.0
"""The demo's page: one self-contained file that embeds its images, so that it can be sent and archived."""

import base64
from html import escape

STYLE = """
:root { color-scheme: light dark; --line: #8884; --soft: #8889; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 1180px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-weight: 600; margin-bottom: 0; } h2 { font-weight: 600; margin: 2.5rem 0 0; }
.lead, figcaption { color: color-mix(in srgb, currentColor 70%, transparent); }
.row { display: grid; grid-template-columns: repeat(auto-fill, minmax(250px, 1fr)); gap: 1rem; margin: 1rem 0; }
figure { margin: 0; } img { width: 100%; display: block; background: #000; border: 1px solid var(--line); }
figcaption { font-size: .85rem; padding-top: .3rem; } figcaption b { color: CanvasText; }
pre { overflow-x: auto; border: 1px solid var(--line); padding: 1rem; font-size: .8rem; }
"""


def figure(path, caption):
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return (f'<figure><img alt="{escape(path.stem)}" src="data:image/png;base64,{data}">'
            f"<figcaption>{caption}</figcaption></figure>")


def caption(shot, bare):
    text = f"<b>{escape(shot.way)}</b>, {shot.frame_ms:.1f} ms a frame"
    if shot is not bare:
        text += f" ({bare.frame_ms / shot.frame_ms:.1f}×), {shot.substituted()} volume draws by Understudy"
    return text


def difference_caption(shot):
    psnr = shot.difference["psnr"]
    return (f"bare against {escape(shot.way)}: max {shot.difference['max']:.4f} (white), "
            f"RMS {shot.difference['rms']:.4f}, PSNR {'∞' if psnr is None else f'{psnr:.2f}'} dB")


def section(scene):
    bare = scene.shots[0]
    figures = [figure(shot.image, caption(shot, bare)) for shot in scene.shots]
    figures += [figure(shot.difference_map, difference_caption(shot)) for shot in scene.shots if shot.difference_map]
    return (f"<section><h2>{escape(scene.name)}</h2><p class='lead'>{escape(scene.what)}</p>"
            f"<div class='row'>{''.join(figures)}</div></section>")


def html(scenes, table):
    return f"""<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Understudy: the demo</title><style>{STYLE}</style>
<h1>Understudy</h1>
<p class="lead">An engine's CT in unmodified viewers: their own drawing (bare), and the same viewers with the volume
ray-cast by Understudy inside the process (embedded) or on MPI ranks. The maps show where the images differ; the bare
image is no reference without error: it is blended in 8 bits.</p>
{''.join(section(scene) for scene in scenes)}
<h2>Figures</h2><pre>{escape(table)}</pre>
</html>
"""
