#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Figures and tables from what isorast-bench has written.

    bench/plot.py FOLDER            NAME.png and NAME.svg beside each FOLDER/NAME.json; tables in Markdown
    bench/plot.py --tables FOLDER   the tables alone: needs no matplotlib
    bench/plot.py --ratios FOLDER   tables of ratios alone, for drivers whose times say little

The figures are those of Kreskowski, Rendle and Froehlich 2022: 6 (resolution), 7a (time-series), 7b
(isovalue-sweep), 8 (stereo); and motion, scaling.
"""
import argparse
import pathlib
import sys

from tables import Results, doubling, median_ms, p95_ms, print_tables, size_name, technique_of, title_of, unique

# Okabe and Ito's palette, which colour-blind readers can tell apart; as in the paper blue is direct, red
# the march, green the stored mesh. Graphics is solid and filled, compute dashed and hollow.
COLORS = {"direct": "#0072B2", "raymarch": "#D55E00", "meshlets": "#009E73"}
OTHERS = ["#CC79A7", "#E69F00", "#56B4E9"]
DOTTED = {"color": "#888888", "lw": 1, "ls": (0, (2, 2))}
LABELS = 1.9  # inches on the right, for the lines' names


def color_of(way):
    technique = technique_of(way)
    return COLORS.get(technique, OTHERS[sum(technique.encode()) % len(OTHERS)])


def style(plt):
    plt.rcParams.update({
        "font.size": 11, "axes.titlesize": 12, "axes.titleweight": "bold", "axes.titlelocation": "left",
        "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#888888",
        "axes.axisbelow": True, "axes.grid": True, "grid.color": "#e6e6e6", "grid.linewidth": 0.8,
        "lines.linewidth": 2.2, "lines.markersize": 6, "xtick.color": "#444444", "xtick.labelsize": 10,
        "ytick.color": "#444444", "ytick.labelsize": 10, "figure.dpi": 110, "savefig.dpi": 160,
        "svg.hashsalt": "isorast"})


def look_of(results, way):
    compute = results.lanes[way] == "compute"
    return {"color": color_of(way), "marker": "o", "linestyle": (0, (4, 1.6)) if compute else "-",
            "markerfacecolor": "white" if compute else color_of(way), "markeredgewidth": 1.6}


def panels(plt, count, width):
    """A row of axes with one scale, and room on the right for labels."""
    total = width * count + LABELS
    figure, axes = plt.subplots(1, count, figsize=(total, 4.4), squeeze=False, sharey=True)
    figure.subplots_adjust(left=0.75 / total, right=1 - LABELS / total, top=0.77, bottom=0.19,
                           wspace=0.12)
    return figure, axes[0]


def log_axis(axis):
    """Plain numbers on a logarithmic axis: 1, 2, 5, 10."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
    axis.set_yscale("log")
    axis.yaxis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_locator(NullLocator())


def ticks(axis, places, names):
    axis.set_xscale("log")
    axis.set_xticks(places, names)
    axis.minorticks_off()


def draw_lines(axis, results, series, labels):
    """A line for each way of {way: ([x], [y])}, with its label at its end where there is one."""
    ends = []
    for way, (xs, ys) in series.items():
        axis.plot(xs, ys, **look_of(results, way))
        if labels.get(way):
            ends.append((xs[-1], ys[-1], labels[way], color_of(way)))
    return ends


def label_ends(axis, ends, gap=14):
    """Writes (x, y, text, color) beside the ends of lines, pushed apart where they would collide."""
    axis.figure.canvas.draw()
    points = sorted((axis.transData.transform((x, y))[1], x, y, text, color)
                    for x, y, text, color in ends)
    scale = axis.figure.dpi / 72
    heights = [point[0] for point in points]
    for _ in range(50):
        for i in range(1, len(heights)):
            missing = gap * scale - (heights[i] - heights[i - 1])
            if missing > 0:
                heights[i - 1] -= missing / 2
                heights[i] += missing / 2
    for height, (at, x, y, text, color) in zip(heights, points):
        axis.annotate(text, (x, y), xytext=(9, (height - at) / scale), textcoords="offset points",
                      color=color, va="center", fontsize=10.5, annotation_clip=False)


def save(figure, results, title, subtitle):
    head = results.json
    inches = figure.get_figheight()
    figure.text(0.012, 1 - 0.22 / inches, title, fontsize=14, weight="bold", va="center")
    figure.text(0.012, 1 - 0.5 / inches, subtitle, fontsize=10, color="#555555", va="center")
    figure.text(0.012, 0.1 / inches, f"{head['device']} \u00b7 {head['driver']} \u00b7 commit {head['commit']}",
                fontsize=8.5, color="#777777")
    for suffix in ("png", "svg"):
        path = results.path.with_suffix("." + suffix)
        figure.savefig(path, metadata={"Date": None} if suffix == "svg" else None)
        print(path, file=sys.stderr)


def draw_resolution(plt, results, title="Draw time against resolution"):
    figure, axes = panels(plt, len(results.volumes), 4.3)
    for axis, volume in zip(axes, results.volumes):
        sizes = results.sizes(volume=volume)
        columns = [(w * h / 1e6, results.at_size(volume, (w, h))) for w, h in sizes]
        series = {}
        for way in results.ways:
            pairs = [(pixels, column[way]) for pixels, column in columns if way in column]
            if pairs:
                series[way] = tuple(zip(*pairs))
        log_axis(axis)
        ticks(axis, [pixels for pixels, _ in columns], map(size_name, sizes))
        axis.set_title(title_of(volume))
        last = axis is axes[-1]
        label_ends(axis, draw_lines(axis, results, series, {way: way for way in series if last}))
    axes[0].set_ylabel("draw time, ms")
    save(figure, results, title, "median frame")


def draw_series(plt, results):
    draw_resolution(plt, results, "A new time step each frame")


def draw_sweep(plt, results):
    figure, axes = panels(plt, len(results.volumes), 7)
    for axis, volume in zip(axes, results.volumes):
        log_axis(axis)
        series = {}
        for way in results.ways:
            color = color_of(way)
            rows = results.pick(volume=volume, way=way, sequence="sweep")
            held = results.pick(volume=volume, way=way, sequence="held")
            axis.plot([row["isovalue"] for row in held], [median_ms([row]) for row in held], "D",
                      color=color, mfc="white", ms=8, mew=1.4, zorder=3)
            if not rows:
                continue
            # There, and back again; "both" where they were not told apart.
            for towards in unique(row["towards"] for row in rows):
                pale = 0.45 if towards == "lower" else 1
                some = sorted((row for row in rows if row["towards"] == towards), key=lambda row: row["isovalue"])
                xs, ys = [row["isovalue"] for row in some], [median_ms([row]) for row in some]
                axis.fill_between(xs, ys, [p95_ms([row]) for row in some], color=color, alpha=0.15 * pale, lw=0)
                axis.plot(xs, ys, **{**look_of(results, way), "marker": None, "alpha": pale})
                series.setdefault(way, (xs, ys))
        axis.set_title(title_of(volume))
        axis.set_xlabel("isovalue, share of the value range")
        if axis is axes[-1]:
            label_ends(axis, [(xs[-1], ys[-1], way, color_of(way)) for way, (xs, ys) in series.items()])
    axes[0].set_ylabel("draw time, ms")
    save(figure, results, "A new isovalue each frame",
         "median, shaded to the 95th percentile; pale: on the way down again; diamonds: held")


def draw_stereo(plt, results):
    views = results.views()
    inches = (2.9 * len(views) + 1.9, 1.9 + 0.36 * len(results.ways))
    figure, axes = plt.subplots(1, len(views), figsize=inches, sharex=True, sharey=True, squeeze=False)
    longest = 100
    for axis, (title, volume, size) in zip(axes[0], views):
        for i, way in enumerate(results.ways):
            share = results.overhead(volume, way, size)
            if share is None:
                continue
            longest = max(longest, 100 * share)
            alpha = 0.55 if results.lanes[way] == "compute" else 1
            axis.barh(i, 100 * share, 0.62, color=color_of(way), alpha=alpha)
            axis.annotate(f"{100 * share:.0f} %", (max(100 * share, 0), i), xytext=(5, 0),
                          textcoords="offset points", va="center", fontsize=10,
                          bbox={"fc": "white", "ec": "none", "pad": 0.8})
        axis.axvline(100, **DOTTED)
        axis.set_title(title)
        axis.set_yticks(range(len(results.ways)), results.ways)
        axis.set_ylim(len(results.ways) - 0.4, -0.6)
        axis.tick_params(axis="y", length=0)
        axis.spines["left"].set_visible(False)
        axis.grid(axis="y", visible=False)
        for tick, way in zip(axis.get_yticklabels(), results.ways):
            tick.set_color(color_of(way))
    axes[0][0].set_xlim(right=longest * 1.3)
    figure.tight_layout(rect=(0, 0.25 / inches[1], 1, 1 - 0.6 / inches[1]))
    save(figure, results, "What a second eye costs", "median frame of two eyes over one; 100 %: as much as the first")


def draw_motion(plt, results):
    views = results.views()
    figure, axes = panels(plt, len(views), 7)
    for axis, (title, volume, size) in zip(axes, views):
        found = {way: results.movements(volume, way, size) for way in results.ways}
        found = {way: [("still", 1, 1), *moves] for way, moves in found.items() if moves}
        names, ends = [], []
        for i, (way, moves) in enumerate(found.items()):
            names, middle, high = zip(*moves)
            xs = [x + (i - (len(found) - 1) / 2) * 0.07 for x in range(len(moves))]
            orbits = len(moves) - names.count("cut")
            axis.plot(xs[:orbits], middle[:orbits], **look_of(results, way))
            axis.plot(xs[orbits:], middle[orbits:], **look_of(results, way))
            axis.vlines(xs, middle, high, color=color_of(way), lw=1.2)
            ends.append((len(moves) - 0.6, middle[-1], way, color_of(way)))
        axis.axhline(1, zorder=0, **DOTTED)
        axis.set_xlim(-0.4, len(names) - 0.6)
        axis.set_xticks(range(len(names)),
                        [name if name in ("still", "cut") else f"{name} a frame" for name in names])
        axis.grid(axis="x", visible=False)
        axis.set_title(title)
        if axis is axes[-1]:
            label_ends(axis, ends)
    axes[0].set_ylabel("draw time, relative")
    save(figure, results, "Motion",
         "orbits over a still picture; a cut's first frame over a warm one; thin lines to the 95th percentile")


def draw_scaling(plt, results):
    formulas = results.formulas()
    figure, axes = panels(plt, len(formulas), 5.2)
    for axis, (name, found) in zip(axes, formulas.items()):
        series, labels = {}, {}
        for way in results.ways:
            pairs = [(side, results.medians(volume=volume).get(way)) for side, volume in found]
            pairs = [pair for pair in pairs if pair[1]]
            if pairs:
                series[way] = tuple(zip(*pairs))
                factor = f"\u00d7{doubling(*series[way]):.2f}"
                labels[way] = f"{way}, {factor}" if axis is axes[-1] else factor
        log_axis(axis)
        ticks(axis, [side for side, _ in found], [f"{side}\u00b3" for side, _ in found])
        axis.margins(x=0.13)
        axis.set_title(name)
        label_ends(axis, draw_lines(axis, results, series, labels))
    axes[0].set_ylabel("draw time, ms")
    save(figure, results, "Draw time against the volume's side", "median frame; \u00d7: what a doubling costs")


FIGURES = {"resolution": draw_resolution, "time-series": draw_series, "isovalue-sweep": draw_sweep,
           "stereo": draw_stereo, "motion": draw_motion, "scaling": draw_scaling}


def draw(measured):
    try:
        import matplotlib
    except ImportError:
        sys.exit("plot.py: error: the figures need matplotlib; install python3-matplotlib, or use --tables")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    style(plt)
    for results in measured:
        if results.scenario in FIGURES:
            FIGURES[results.scenario](plt, results)


def main():
    parser = argparse.ArgumentParser(description="Figures and tables from what isorast-bench has written.")
    parser.add_argument("paths", nargs="+", type=pathlib.Path, help="JSON files, or folders of them")
    parser.add_argument("--tables", action="store_true", help="tables alone")
    parser.add_argument("--ratios", action="store_true", help="tables of ratios alone")
    arguments = parser.parse_args()
    files = []
    for path in arguments.paths:
        files += sorted(path.glob("*.json")) if path.is_dir() else [path]
    if not files:
        sys.exit(f"plot.py: error: {arguments.paths[0]}: expected .json files of isorast-bench, found none")
    measured = []
    for file in files:
        try:
            measured.append(Results(file))
        except (OSError, ValueError, KeyError) as error:
            sys.exit(f"plot.py: error: {file}: expected a JSON file of isorast-bench, found {error!r}")
    measured = [results for results in measured if results.rows]
    for results in measured:
        print_tables(results, arguments.ratios)
    if not arguments.tables and not arguments.ratios:
        draw(measured)


if __name__ == "__main__":
    main()
