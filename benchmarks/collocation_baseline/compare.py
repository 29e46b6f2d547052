"""`protean plan` and the solvers in turn on every instance of a file, and one table."""

import numpy as np

from . import instance, plan, protean, reference


def least(results):
    """The result with the least CPU time; the plans of all are the same."""
    return min(results, key=lambda result: result["cpu_ms"])


def rows(path, args, say):
    """A row {id, protean?, fatrop?, ipopt?, reference_s?} for every instance, and notes."""
    stored = reference.load(path)
    found, notes = [], []
    effort = plan.Effort(args.n, args.starts, args.repairs)
    raws = instance.load(path, args.limit)
    for done, raw in enumerate(raws, start=1):
        if args.reverse:
            raw = raw | {"v_min": -raw["vmax_px_s"]}
        try:
            problem = instance.parse(raw)
        except instance.Refused as refusal:
            notes.append(f"{raw.get('id')} {refusal}")
            continue
        row = {"id": problem.id, "reference_s": None if args.reverse else stored.get(problem.id)}
        if args.protean:
            row["protean"] = protean.judged(problem, protean.run(args.protean, args.method, raw, args.repeat))
        for solver in args.solvers:
            row[solver] = least([plan.solve(problem, [solver], effort) for _ in range(args.repeat)])
        found.append(row)
        say(f"{done}/{len(raws)} {problem.id}: " + ", ".join(told(name, row[name]) for name in names(row)))
        for name in names(row):
            if not row[name]["honest"]:
                notes.append(f"{problem.id}, {name}: {'; '.join(row[name].get('reasons') or [row[name]['status']])}")
    return found, notes


def names(row):
    return [name for name in ("protean", "fatrop", "ipopt") if name in row]


def told(name, result):
    time = "-" if result.get("t_s") is None else f"{result['t_s']:.4f} s"
    return f"{name} {time} {result.get('cpu_ms') or 0.0:.1f} ms" + ("" if result["honest"] else " (not valid)")


def best(row):
    """The least time of any valid solution of the row, the reference included."""
    times = [row[name]["t_s"] for name in names(row) if row[name]["honest"]]
    times += [row["reference_s"]] if row["reference_s"] else []
    return min(times, default=None)


def spread(values):
    """Median, 95th percentile and greatest, or `None` of nothing."""
    values = [value for value in values if value is not None]
    if not values:
        return None
    median, p95, greatest = np.percentile(values, [50, 95, 100])
    return {"median": float(median), "p95": float(p95), "max": float(greatest), "n": len(values)}


def summarise(found):
    """The figures of one file, by solver."""
    summary = {"instances": len(found), "reference": sum(row["reference_s"] is not None for row in found)}
    for name in ("protean", "fatrop", "ipopt"):
        having = [row for row in found if name in row]
        if not having:
            continue
        valid = [row for row in having if row[name]["honest"]]
        gap = lambda row, to: None if to is None else row[name]["t_s"] / to - 1.0
        summary[name] = {
            "valid": len(valid),
            "cpu_ms": spread([row[name].get("cpu_ms") for row in having]),
            "gap_to_best": spread([gap(row, best(row)) for row in valid]),
            "gap_to_reference": spread([gap(row, row["reference_s"]) for row in valid]),
        }
        timed = [row for row in having if name != "protean" and (row.get("protean") or {}).get("cpu_ms")]
        ratios = [row[name]["cpu_ms"] / row["protean"]["cpu_ms"] for row in timed]
        summary[name]["cpu_over_protean"] = spread(ratios)
        summary[name]["faster_than_protean"] = sum(ratio < 1.0 for ratio in ratios)
    return summary


HEAD = (
    "| instances | planner | valid | CPU, median / p95 (ms) | its CPU / ours, median (it is faster on) "
    "| above the best of any, median / max (%) | above the reference, median / max (%) |\n|---|---|---|---|---|---|---|"
)


def lines(name, summary):
    """The summary of one file as rows of the table."""

    def two(values, first, second, digits, scale=1.0):
        if values is None:
            return "-"
        return f"{scale * values[first]:.{digits}f} / {scale * values[second]:.{digits}f}"

    for planner, title in (("protean", "Protean"), ("fatrop", "FATROP"), ("ipopt", "IPOPT")):
        each = summary.get(planner)
        if each is None:
            continue
        ratio = each["cpu_over_protean"]
        ratio = "" if ratio is None else f"{ratio['median']:.2f} ({each['faster_than_protean']} of {ratio['n']})"
        yield (
            f"| {name} | {title} | {each['valid']} of {summary['instances']} "
            f"| {two(each['cpu_ms'], 'median', 'p95', 2)} | {ratio} "
            f"| {two(each['gap_to_best'], 'median', 'max', 4, 100.0)} "
            f"| {two(each['gap_to_reference'], 'median', 'max', 4, 100.0)} |"
        )
