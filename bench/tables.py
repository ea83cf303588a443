# SPDX-License-Identifier: MIT
"""What isorast-bench has written, and tables of it in Markdown."""
import json
import math
import pathlib

SIZES = {(1280, 720): "720p", (1920, 1080): "1080p", (2560, 1440): "1440p", (3840, 2160): "4K",
         (7680, 4320): "8K"}
CULLING_PASSES = ("cull", "depth pyramid", "surface pyramid", "raster proxies", "guess visible",
                  "list blocks")


def size_name(size):
    return SIZES.get(size, f"{size[0]}x{size[1]}")


def technique_of(way):
    return way.split()[0]


def unique(items):
    return list(dict.fromkeys(items))


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def median_ms(rows):
    return mean(row["frame"]["median_ms"] for row in rows)


def p95_ms(rows):
    return mean(row["frame"]["p95_ms"] for row in rows)


def title_of(volume):
    """"head:256:type=u8" is "head, 256^3 u8"; a file keeps its name."""
    parts = volume.split(":")
    if len(parts) < 2:
        return pathlib.Path(volume).stem
    words = [f"{parts[1]}\u00b3" if parts[1].isdigit() else parts[1]]
    words += [part.split("=")[1] for part in parts[2:] if part.startswith("type=")]
    words += [part.split("=")[1] + " steps" for part in parts[2:] if part.startswith("steps=")]
    return f"{parts[0]}, {' '.join(words)}"


class Results:
    """The rows of one scenario, and how to pick from them."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.json = json.loads(self.path.read_text())
        self.scenario = self.json["scenario"]
        self.rows = self.json["rows"]
        self.volumes = unique(row["volume"] for row in self.rows)
        self.ways = unique(row["way"] for row in self.rows)
        self.lanes = {row["way"]: row["lane"] for row in self.rows}

    def pick(self, **wanted):
        return [row for row in self.rows
                if all(row.get(key) == value for key, value in wanted.items())]

    def medians(self, **wanted):
        """{way: milliseconds}: the mean of the medians where several rows fit."""
        found = {way: self.pick(way=way, **wanted) for way in self.ways}
        return {way: median_ms(rows) for way, rows in found.items() if rows}

    def sizes(self, **wanted):
        return unique((row["width"], row["height"]) for row in self.pick(**wanted))

    def views(self):
        """[(title, volume, size)]; the title names the size where there are several."""
        several = len(self.sizes()) > 1
        return [(title_of(volume) + (f", {size_name(size)}" if several else ""), volume, size)
                for volume in self.volumes for size in self.sizes(volume=volume)]

    def at_size(self, volume, size):
        """{way: milliseconds}; of a time series, all steps in turn, but for a stored mesh those held."""
        where = {"volume": volume, "width": size[0], "height": size[1]}
        found = {}
        for sequence in ("held", "series", "still"):
            found.update(self.medians(sequence=sequence, **where))
        return found

    def overhead(self, volume, way, size):
        """By what share two eyes cost more than one."""
        where = {"volume": volume, "way": way, "width": size[0], "height": size[1]}
        mono = self.pick(sequence="mono", **where)
        both = self.pick(sequence="stereo", **where)
        return median_ms(both) / median_ms(mono) - 1 if mono and both else None

    def movements(self, volume, way, size):
        """[(name, median, p95)]: orbits over the still picture; a cut's cold frame over a warm one."""
        def over(name, rows, base):
            return (name, median_ms(rows) / median_ms(base), p95_ms(rows) / median_ms(base))

        where = {"volume": volume, "way": way, "width": size[0], "height": size[1]}
        still = self.pick(sequence="still", **where)
        orbits = self.pick(sequence="orbit", **where)
        found = [over(f"{row['degrees']:g}\u00b0", [row], still) for row in orbits if still]
        cold, warm = (self.pick(sequence="cut", moment=moment, **where) for moment in ("cold", "warm"))
        return found + ([over("cut", cold, warm)] if cold and warm else [])

    def formulas(self):
        """{formula: [(side, volume)]}, in the order of the sides; if some come in several, those alone."""
        found = {}
        for volume in self.volumes:
            parts = volume.split(":")
            if len(parts) > 1 and parts[1].isdigit():
                name = " ".join([parts[0], *(part.split("=")[1] for part in parts[2:])])
                found.setdefault(name, []).append((int(parts[1]), volume))
        several = {name: sides for name, sides in found.items() if len(sides) > 1}
        return {name: sorted(sides) for name, sides in (several or found).items()}


def doubling(sides, times):
    """The factor by which a frame's time grows with each doubling of the side, on average."""
    octaves = math.log2(sides[-1] / sides[0])
    return (times[-1] / times[0]) ** (1 / octaves) if octaves else 1


def culling_share(row):
    """Of the frame, the passes that find out what is visible, but cull seen beside the clear."""
    passes = row["passes"].items()
    spent = sum(times["median_ms"] for name, times in passes if name.startswith(CULLING_PASSES))
    return spent / row["frame"]["median_ms"]


def ratio_lines(results, columns):
    """March over direct in each lane and best against best, and direct over the stored mesh."""
    def best(technique, lane):
        ways = [way for way in results.ways
                if technique_of(way) == technique and lane in ("best", results.lanes[way])]
        found = [[column[way] for way in ways if way in column] for column in columns]
        return [min(values) if values else None for values in found]

    for lane in ("graphics", "compute", "best"):
        for above, below in (("raymarch", "direct"), ("direct", "meshlets")):
            pairs = list(zip(best(above, lane), best(below, lane)))
            if any(a and b for a, b in pairs):
                cells = [f"{a / b:.2f}" if a and b else "" for a, b in pairs]
                yield f"{above} / {below}, {lane}", cells


def print_table(head, lines):
    print("\n| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|")
    for name, cells in lines:
        print(f"| {name} | " + " | ".join(cells) + " |")


def print_times(results, first, names, columns, ratios_only):
    """A column {way: milliseconds} for each of the names; then their ratios."""
    lines = []
    for way in [] if ratios_only else results.ways:
        cells = [f"{column[way]:.3f}" if way in column else "" for column in columns]
        lines.append((f"{way} ({results.lanes[way]}), ms", cells))
    print_table([first, *names], lines + list(ratio_lines(results, columns)))


def print_growth(results, name, pairs, what):
    """Last over first of [(x, {way: milliseconds})], by way."""
    lines = []
    for way in results.ways:
        found = [(x, column[way]) for x, column in pairs if way in column]
        if len(found) > 1:
            lines.append((way, [f"{what[1](*zip(*found)):.2f}"]))
    print_table([name, what[0]], lines)


def resolution_table(results, ratios_only):
    for volume in results.volumes:
        sizes = results.sizes(volume=volume)
        columns = [results.at_size(volume, size) for size in sizes]
        names = [size_name(size) for size in sizes]
        print_times(results, title_of(volume), names, columns, ratios_only)
        if (1280, 720) in sizes and (3840, 2160) in sizes:
            pairs = [pair for pair in zip(sizes, columns) if size_name(pair[0]) in ("720p", "4K")]
            print_growth(results, title_of(volume), pairs, ("4K / 720p", lambda _, ms: ms[-1] / ms[0]))
    print_shares(results)


def print_shares(results):
    """Of each volume at the last size: memory beside it, culling's share of the frame, blocks."""
    lines = []
    for way in results.ways:
        cells = []
        for volume in results.volumes:
            rows = results.pick(volume=volume, way=way)
            if not rows:
                cells.append("")
                continue
            row = rows[-1]
            words = [f"{100 * row['extra_bytes'] / row['volume_bytes']:.2f} %"]
            if row["blocks_active"]:
                words += [f"{100 * culling_share(row):.0f} %",
                          f"{row['blocks_drawn']} of {row['blocks_active']}"]
            cells.append("; ".join(words))
        lines.append((way, cells))
    print_table(["memory beside the volume; culling's share; blocks drawn of active",
                 *map(title_of, results.volumes)], lines)


def sweep_table(results, ratios_only):
    for volume in results.volumes:
        sweep = results.pick(volume=volume, sequence="sweep")
        if not sweep:
            continue
        worst = max((row for row in sweep if row["way"] == sweep[0]["way"]),
                    key=lambda row: row["frame"]["median_ms"])
        picks = {"mean of the sweep": {}}
        for towards in sorted({row["towards"] for row in sweep} & {"higher", "lower"}):
            picks[f"to {towards} isovalues"] = {"towards": towards}
        picks[f"slowest, {worst['isovalue']:.3g}"] = {key: worst[key] for key in ("isovalue", "towards")}
        names = list(picks)
        columns = [results.medians(volume=volume, sequence="sweep", **more) for more in picks.values()]
        print_times(results, title_of(volume), names, columns, ratios_only)
        lines = []
        for way in results.ways:
            held = results.pick(volume=volume, way=way, sequence="held")
            at = {row["isovalue"] for row in held}
            moving = [row for row in sweep if row["way"] == way and row["isovalue"] in at]
            if held and moving:
                lines.append((way, [f"{median_ms(moving) / median_ms(held):.2f}"]))
        print_table([title_of(volume), "changing / held, over the isovalues held"], lines)


def stereo_table(results, ratios_only):
    for size in results.sizes():
        views = [view for view in results.views() if view[2] == size]
        lines = []
        for way in results.ways:
            found = [results.overhead(volume, way, size) for _, volume, _ in views]
            lines.append((f"{way} ({results.lanes[way]})",
                          ["" if share is None else f"{100 * share:.0f} %" for share in found]))
        print_table(["a second eye costs", *(title for title, _, _ in views)], lines)


def motion_table(results, ratios_only):
    for title, volume, size in results.views():
        found = {way: results.movements(volume, way, size) for way in results.ways}
        found = {way: moves for way, moves in found.items() if moves}
        if not found:
            continue
        names = [name for name, _, _ in next(iter(found.values()))]
        lines = [(f"{way} ({results.lanes[way]})",
                  [f"{median:.2f} ({p95:.2f})" for _, median, p95 in moves])
                 for way, moves in found.items()]
        print_table([f"{title}: over a still picture, median (p95)", *names], lines)


def scaling_table(results, ratios_only):
    for name, found in results.formulas().items():
        columns = [results.medians(volume=volume) for _, volume in found]
        sides = [side for side, _ in found]
        print_times(results, name, [f"{side}\u00b3" for side in sides], columns, ratios_only)
        print_growth(results, name, list(zip(sides, columns)), ("a doubling costs", doubling))


TABLES = {"frames": resolution_table, "resolution": resolution_table,
          "time-series": resolution_table, "isovalue-sweep": sweep_table, "stereo": stereo_table,
          "motion": motion_table, "scaling": scaling_table}


def print_tables(results, ratios_only):
    head = results.json
    print(f"\n### {results.scenario}\n")
    print(f"{head['device']}, {head['driver']}, commit {head['commit']}: `{head['command']}`")
    TABLES[results.scenario](results, ratios_only)
    worst = {}
    for found in head["agreement"]:
        known = worst.setdefault(found["way"], [1, 0])
        worst[found["way"]] = [min(known[0], found["overlap"]),
                               max(known[1], found["depth_voxels"])]
    if worst:
        print("\nAgreement at worst (silhouette overlap, mean depth difference in voxels): "
              + ", ".join(f"{way} {overlap:.4f}, {depth:.2f}"
                          for way, (overlap, depth) in worst.items()) + ".")
    for why in unique(f"{skip['way']}: {skip['why']}" for skip in head["skipped"]):
        print(f"\nLeft out: {why}.")
