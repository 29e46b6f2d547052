#!/usr/bin/env python3
"""Quality of plans: how many are within 0.3 % of their references, and on what they rest.

    protean plan ties.json --out ties.plans.json
    python3 benchmarks/shares.py ties.json ties.plans.json

References: `ties.reference.json` beside the instances, by `benchmarks/collocation_baseline.py reference`. Other plans of the
same instances can stand in for them: `--reference FILE`. No other package is needed.
"""

import argparse
import collections
import json
import pathlib

WITHIN = 3e-3


def lines(path):
    text = pathlib.Path(path).read_text(encoding="utf-8")
    return json.loads(text) if text.lstrip().startswith("[") else [json.loads(line) for line in text.splitlines()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("instances", metavar="INSTANCES.json")
    parser.add_argument("plans", metavar="PLANS")
    parser.add_argument("--reference", metavar="FILE")
    args = parser.parse_args()
    reference = args.reference or pathlib.Path(args.instances).with_suffix(".reference.json")
    best = {entry["id"]: entry["t_s"] for entry in lines(reference) if entry.get("t_s")}
    names = {instance["id"] for instance in lines(args.instances)}
    plans = [plan for plan in lines(args.plans) if plan["id"] in names]
    driven = [plan for plan in plans if plan["t_s"] is not None]
    over = {plan["id"]: plan["t_s"] / best[plan["id"]] - 1.0 for plan in driven if plan["id"] in best}
    within = sum(value <= WITHIN for value in over.values())
    count = lambda key: dict(sorted(collections.Counter(str(plan[key]) for plan in plans).items()))
    print(f"{len(plans)} of {len(names)} planned instances, {sum(plan['honest'] is True for plan in driven)} honest")
    print(f"status {count('status')}, basis {count('basis')}")
    print(f"failed searches: {sum(plan['failed_searches'] or 0 for plan in plans)}")
    print(f"at most {100 * WITHIN:.1f} % over the reference: {within} of {len(over)}")
    for name, value in sorted(over.items(), key=lambda pair: -pair[1]):
        if value > WITHIN:
            print(f"    {name}: {100 * value:.2f} %")
    print(f"largest CPU time: {max((plan['cpu_ms'] or 0.0 for plan in plans), default=0.0):.1f} ms")


if __name__ == "__main__":
    main()
