"""Draw the curves of `train.py`.

    python draw.py ../../docs/images/first-policy.svg
"""

import csv
import sys
from pathlib import Path

FOLDER = Path(__file__).parent
CURVES = {"hello": "hello", "two_police": "two Police", "even": "fast Police, residual"}
LEFT, WIDTH, TOP, HEIGHT = 50, 150, 30, 150


def panel(name, title, left):
    """Returns the curve of a game, beside others."""
    with open(FOLDER / f"{name}.csv", newline="") as file:
        rows = [(int(row["steps"]), int(row["escapes"])) for row in csv.DictReader(file)]
    last = rows[-1][0]
    points = " ".join(f"{left + WIDTH * x / last:.1f},{TOP + HEIGHT * (1 - y / 24):.1f}" for x, y in rows)
    lines = [f'<path d="M{left} {TOP + HEIGHT * k // 2}h{WIDTH}" stroke="#ccc"/>' for k in range(3)]
    lines += [f'<polyline points="{points}" fill="none" stroke="#06c" stroke-width="2"/>']
    middle = f'x="{left + WIDTH // 2}" text-anchor="middle"'
    lines += [f'<text {middle} y="{TOP - 12}">{title}</text>']
    lines += [f'<text {middle} y="{TOP + HEIGHT + 20}">0 to {last} steps</text>']
    return lines


def main(path):
    width, height = LEFT + len(CURVES) * (WIDTH + 20), TOP + HEIGHT + 30
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}"'
    lines = [f'{head} font-family="sans-serif" font-size="12">']
    lines += [f'<rect width="{width}" height="{height}" fill="white"/>']
    for k, label in enumerate(["24", "12", "0"]):
        lines += [f'<text x="{LEFT - 6}" y="{TOP + HEIGHT * k // 2 + 4}" text-anchor="end">{label}</text>']
    for k, (name, title) in enumerate(CURVES.items()):
        lines += panel(name, title, LEFT + k * (WIDTH + 20))
    Path(path).write_text("\n".join([*lines, "</svg>", ""]))


if __name__ == "__main__":
    main(sys.argv[1])
