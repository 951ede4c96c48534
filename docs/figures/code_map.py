#!/usr/bin/env python3
"""Draws the two pictures of docs/architecture.md: one skin and one frame on their way through the crates.

    python3 docs/figures/code_map.py

writes docs/images/one-skin.svg and docs/images/one-frame.svg. It needs Python's standard library only and gives the
same bytes on every run. A picture is a list of boxes and arrows; change a name here when it changes in the code.
"""

from dataclasses import dataclass
from html import escape
from pathlib import Path

IMAGES = Path(__file__).resolve().parent.parent / "images"

BOX_HEIGHT = 64
SANS = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', Helvetica, Arial, sans-serif"
MONO = "ui-monospace, 'SF Mono', Menlo, Consolas, 'DejaVu Sans Mono', monospace"

# Crate: (light border, light fill, dark border, dark fill).
CRATES = {
    "geometry": ("#0f766e", "#ecfdf9", "#5eead4", "#10312e"),
    "model": ("#1d4ed8", "#eff5ff", "#93b4ff", "#16233f"),
    "patch": ("#7e22ce", "#f8f2ff", "#d3a6fb", "#2c1a3d"),
    "link": ("#b45309", "#fff7e8", "#fbbf5f", "#36260d"),
    "shared": ("#15803d", "#effcf2", "#7ee2a0", "#122d1b"),
    "simulate": ("#be185d", "#fff1f7", "#f9a8d0", "#3a1727"),
    "firmware": ("#475569", "#f3f5f8", "#b6c2d2", "#222a35"),
    "outside": ("#6b7280", "#ffffff", "#9ca3af", "#0d1117"),
}


@dataclass(frozen=True)
class Box:
    """One step: what happens, the functions that do it, and what comes out."""

    x: int
    y: int
    crate: str
    title: str
    code: str
    out: str
    width: int = 290

    left = property(lambda self: (self.x, self.y + BOX_HEIGHT // 2))
    right = property(lambda self: (self.x + self.width, self.y + BOX_HEIGHT // 2))
    top = property(lambda self: self.at_top(0.5))
    bottom = property(lambda self: self.at_bottom(0.5))

    def at_top(self, share):
        return (self.x + round(self.width * share), self.y)

    def at_bottom(self, share):
        return (self.x + round(self.width * share), self.y + BOX_HEIGHT)

    def draw(self):
        x, y = self.x, self.y
        chip = f'<text class="chip {self.crate}-ink" x="{x + self.width - 12}" y="{y + 19}">{escape(self.crate)}</text>'
        return [
            f'<rect class="{self.crate}" x="{x}" y="{y}" width="{self.width}" height="{BOX_HEIGHT}" rx="7"/>',
            f'<rect class="{self.crate}-bar" x="{x}" y="{y + 7}" width="4" height="{BOX_HEIGHT - 14}"/>',
            f'<text class="title" x="{x + 14}" y="{y + 20}">{escape(self.title)}</text>',
            chip,
            f'<text class="code" x="{x + 14}" y="{y + 38}">{escape(self.code)}</text>',
            f'<text class="out" x="{x + 14}" y="{y + 55}">{escape(self.out)}</text>',
        ]


def arrow(*points, label=None, label_at=None):
    """A line through `points` with a head at its end."""
    path = "M" + " L".join(f"{x} {y}" for x, y in points)
    drawn = [f'<path class="line" d="{path}" marker-end="url(#head)"/>']
    if label:
        x, y = label_at
        drawn.append(f'<text class="note" x="{x}" y="{y}">{escape(label)}</text>')
    return drawn


def frame(x, y, width, height, label):
    """A dashed frame round the steps that one function calls."""
    return [
        f'<rect class="frame" x="{x}" y="{y}" width="{width}" height="{height}" rx="11"/>',
        f'<text class="frame-label" x="{x + width - 30}" y="{y + 18}">{escape(label)}</text>',
    ]


def note(x, y, *lines, anchor="start"):
    """Lines of small text."""
    return [
        f'<text class="note" text-anchor="{anchor}" x="{x}" y="{y + 16 * n}">{escape(line)}</text>'
        for n, line in enumerate(lines)
    ]


def heading(x, y, text):
    return [f'<text class="heading" x="{x}" y="{y}">{escape(text)}</text>']


def style():
    def colours(dark):
        page, ink, soft, line = (
            ("#0d1117", "#e6edf3", "#a3aebb", "#8b97a5") if dark else ("#ffffff", "#1b2330", "#566172", "#6b7685")
        )
        rules = [
            f".page {{ fill: {page} }}",
            f".title, .code, .heading {{ fill: {ink} }}",
            f".out, .note, .frame-label {{ fill: {soft} }}",
            f".line, .frame {{ stroke: {line} }}",
            f".head {{ fill: {line} }}",
        ]
        for crate, (border, fill, dark_border, dark_fill) in CRATES.items():
            edge, inside = (dark_border, dark_fill) if dark else (border, fill)
            rules.append(f".{crate} {{ fill: {inside}; stroke: {edge} }}")
            rules.append(f".{crate}-bar, .{crate}-ink {{ fill: {edge} }}")
        return rules

    fixed = [
        f"text {{ font-family: {SANS} }}",
        "rect { stroke-width: 1.2 }",
        ".page, .head { stroke: none }",
        ".title { font-size: 14px; font-weight: 600 }",
        ".heading { font-size: 16px; font-weight: 700 }",
        ".chip { font-size: 11px; font-weight: 600; text-anchor: end }",
        f".code {{ font-family: {MONO}; font-size: 11.5px }}",
        ".out, .note { font-size: 12px }",
        f".frame-label {{ font-family: {MONO}; font-size: 11.5px; text-anchor: end }}",
        ".line { fill: none; stroke-width: 1.5 }",
        ".frame { fill: none; stroke-width: 1.2; stroke-dasharray: 5 4 }",
    ]
    dark = " ".join(colours(dark=True))
    lines = [*fixed, *colours(dark=False), f"@media (prefers-color-scheme: dark) {{ {dark} }}"]
    return "<style>\n" + "\n".join(lines) + "\n</style>"


def picture(name, width, height, title, *parts):
    """Writes a picture; `parts` are lists of SVG elements, in the order in which they are drawn."""
    head = (
        '<defs><marker id="head" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" orient="auto">'
        '<path class="head" d="M0 0 L10 5 L0 10 z"/></marker></defs>'
    )
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        f'role="img" aria-label="{escape(title)}">',
        "<!-- Made by docs/figures/code_map.py. -->",
        f"<title>{escape(title)}</title>",
        style(),
        head,
        f'<rect class="page" width="{width}" height="{height}" rx="10"/>',
        *(line for part in parts for line in part if line),
        "</svg>",
    ]
    (IMAGES / f"{name}.svg").write_text("\n".join(lines) + "\n", encoding="utf-8")


HOW_TO_READ = "In a box: the crate at its right, module::function, and what comes out."


def one_skin():
    """From skin file to patch on the board."""
    width = 290
    left, middle, right = 26, 340, 654
    row = [86 + 98 * n for n in range(8)]
    read = Box(middle, row[0], "model", "Skin", "skin::Skin::load, made", "a checked description, then its mesh")
    steps = Box(left, row[1], "model", "Steps", "skin::Skin::stimulation", "[step], and each step's measurement")
    mesh = Box(middle, row[1], "geometry", "Mesh", "mesh::generate or mesh::import", "nodes, triangles, electrodes")
    forward = Box(
        middle, row[2], "model", "Forward model", "forward::ForwardModel::new, solve", "fields [unknown][electrode]"
    )
    pixels = Box(
        right, row[2], "model", "Pixels", "pixels::raster, per_element, patches", "share of each element [pixel]"
    )
    jacobian = Box(
        middle, row[3], "model", "Jacobian", "jacobian::jacobian, combine_rows", "sensitivity [measurement][pixel]"
    )
    prior = Box(right, row[3], "model", "Prior", "prior::Prior::new", "R [pixel][pixel]")
    matrix = Box(middle, row[4], "model", "Matrix", "inverse::reconstruction::reconstruct", "f64 [pixel][measurement]")
    fixed = Box(
        middle,
        row[5] + 26,
        "model",
        "Fixed point",
        "quantize::interpolation, fixed_point",
        "i16, with row and column exponents",
    )
    tables = Box(
        right, row[5] + 26, "patch", "Surface tables", "pixels::Pixels::surface_tables", "place, normal, neighbours [pixel]"
    )
    patch = Box(
        middle, row[6] + 26, "shared", "Patch", "patch::write::Contents::write", "NAME.dermatome, checked by validate"
    )
    upload = Box(middle, row[7] + 54, "link", "Upload", "upload", "pieces of 512 bytes, in order")
    board = Box(
        right, row[7] + 54, "shared", "On the board", "device::Device::handle", "an idle flash slot, then its record"
    )
    boxes = [read, steps, mesh, forward, pixels, jacobian, prior, matrix, fixed, tables, patch, upload, board]
    build_top, build_end = row[1] - 28, row[4] + BOX_HEIGHT + 14
    patch_top, patch_end = row[5] - 2, row[6] + 26 + BOX_HEIGHT + 14
    outer, turn = right + width + 9, row[3] - 17
    column = [x + width // 2 for x in (left, middle, right)]
    picture(
        "one-skin",
        980,
        upload.y + BOX_HEIGHT + 26,
        "One skin: from skin file to patch",
        heading(left, 36, "One skin: from skin file to patch"),
        note(left, 57, HOW_TO_READ),
        note(column[1] + 12, 79, "skin.toml"),
        arrow((column[1], 68), read.top),
        frame(left - 14, build_top, 956, build_end - build_top, "model::model::Model::build"),
        frame(middle - 14, patch_top, 642, patch_end - patch_top, "model::quantize::patch"),
        *(box.draw() for box in boxes),
        arrow(read.left, (column[0], read.left[1]), steps.top),
        arrow(read.bottom, mesh.top),
        arrow(mesh.bottom, forward.top),
        arrow(mesh.right, (column[2], mesh.right[1]), pixels.top),
        arrow(steps.bottom, (column[0], jacobian.left[1]), jacobian.left),
        arrow(forward.bottom, jacobian.top),
        arrow(
            pixels.at_bottom(0.12),
            (pixels.at_bottom(0.12)[0], turn),
            (jacobian.at_top(0.8)[0], turn),
            jacobian.at_top(0.8),
        ),
        arrow(pixels.bottom, prior.top),
        arrow(jacobian.bottom, matrix.top),
        arrow(prior.bottom, (column[2], matrix.right[1]), matrix.right),
        arrow(matrix.bottom, fixed.top),
        arrow(pixels.right, (outer, pixels.right[1]), (outer, tables.right[1]), tables.right),
        arrow(fixed.bottom, patch.top),
        arrow(tables.bottom, (column[2], patch.right[1]), patch.right),
        arrow((left + 40, steps.bottom[1]), (left + 40, patch.left[1]), patch.left),
        note(left + 52, patch.left[1] - 10, "stimulation table"),
        arrow(patch.bottom, upload.top),
        arrow(upload.right, board.left),
        note(
            left,
            upload.y + 14,
            "Before it is written, quantize::",
            "fixed_point_error tries 1,000 random presses",
            "and compares with the f64 matrix.",
        ),
    )


def one_frame():
    """From samples to contacts on the host."""
    width, left, right = 330, 56, 556
    centre = [x + width // 2 for x in (left, right)]
    y = 92
    ys = []
    for gap in (0, 22, 22, 48, 48, 22, 22, 22, 22, 36, 42):
        y += gap
        ys.append(y)
        y += BOX_HEIGHT
    board = [
        ("firmware", "Samples", "drivers::front_end, tasks::acquire", "12 bits at 2 MS/s, by timers and DMA"),
        ("shared", "Lock-in", "demodulate::Demodulator::push", "in phase and quadrature of each slot"),
        ("shared", "Frame", "acquire::Acquisition::push", "codes [step], electrode tests, time, flags"),
        ("shared", "Health", "health::Health::examine", "bad electrodes, flags"),
        ("shared", "Difference", "reference::Reference::relative_change", "f32 [measurement], bad ones masked"),
        ("shared", "Drift", "drift::Drift::correct", "then i16, DifferenceData::quantise"),
        ("shared", "Image", "reconstruct::reconstruct", "i32 in 2^-20 [pixel]"),
        ("shared", "Contacts", "contact::find", "place, normal, area, strength; 8 at most"),
        ("shared", "Pressure", "hysteresis::Places::compensate", "play operators, then Calibration::apply"),
        ("shared", "Events", "device::Device::process", "contacts, health, measurements, image"),
        ("shared", "Packets", "protocol::encode, EventQueue", "postcard, CRC-32, COBS"),
    ]
    board = [Box(left, top, *words, width) for top, words in zip(ys, board)]
    _, _, frame_box, health, change, _, _, _, pressure, events, packets = board

    simulated = Box(
        right,
        frame_box.y,
        "simulate",
        "Simulated skin",
        "instrument::Instrument::scan",
        "a forward solution, noise, a converter",
        width,
    )
    wire = Box(right, packets.y, "link", "Bytes", "wire::Wire::receive", "packets, by shared PacketReader::push", width)
    event = Box(
        right, events.y, "link", "Replies and events", "Subscription::next_while", "the one loop; gaps in event numbers are counted", width
    )
    whole = Box(
        right,
        pressure.y - 20,
        "link",
        "Whole frames",
        "Assembler::take",
        "one scan's events joined; lost ones counted",
        width,
    )
    host = [wire, event, whole]
    uses = [
        ("shared::track::Tracker::update", "contacts with numbers that stay"),
        ("link::contacts::ContactTracker", "place and normal in the robot link's frame"),
        ("model::multi_contact", "fingers fitted to the voltages"),
        ("view, command", "live picture, lines for a pipe, JSON"),
    ]
    uses_height = 34 + 37 * len(uses)
    uses_y = whole.y - 42 - uses_height
    used_by = [
        f'<rect class="outside" x="{right}" y="{uses_y}" width="{width}" height="{uses_height}" rx="7"/>',
        f'<text class="title" x="{right + 14}" y="{uses_y + 22}">Used by</text>',
    ]
    for n, (code, what) in enumerate(uses):
        line_y = uses_y + 44 + 37 * n
        used_by.append(f'<text class="code" x="{right + 14}" y="{line_y}">{escape(code)}</text>')
        used_by.append(f'<text class="out" x="{right + 14}" y="{line_y + 16}">{escape(what)}</text>')

    device_top, device_end = health.y - 30, events.y + BOX_HEIGHT + 14
    pipeline_top, pipeline_end = change.y - 30, pressure.y + BOX_HEIGHT + 14
    aside = left + width + 44
    picture(
        "one-frame",
        910,
        packets.y + BOX_HEIGHT + 26,
        "One frame: from samples to contacts",
        heading(26, 36, "One frame: from samples to contacts"),
        note(26, 57, HOW_TO_READ),
        note(left, ys[0] - 10, "The board, or the simulated one"),
        note(right, uses_y - 10, "The host"),
        frame(left - 30, device_top, width + 60, device_end - device_top, "device::Device::process"),
        frame(left - 15, pipeline_top, width + 30, pipeline_end - pipeline_top, "pipeline::process"),
        *(box.draw() for box in [*board, simulated, *host]),
        used_by,
        *(arrow(above.bottom, below.top) for above, below in zip(board, board[1:])),
        arrow(simulated.left, frame_box.right),
        arrow(packets.right, wire.left),
        note((packets.right[0] + wire.left[0]) // 2, packets.right[1] - 10, "serial line or TCP", anchor="middle"),
        arrow(wire.top, event.bottom),
        arrow(event.top, whole.bottom),
        arrow(whole.top, (centre[1], uses_y + uses_height)),
        note(aside, change.y - 6, "During a tare a frame goes into reference::Tare::add, and no further."),
        note(aside, change.y + 24, "Untouched, the reference follows: reference::Reference::follow."),
    )


if __name__ == "__main__":
    one_skin()
    one_frame()
