"""Compares two results: what got better or worse by more than the noise."""
import summary

TIME_FLOOR = 0.10    # relative; and the quartiles must not overlap
ERROR_FLOOR = 0.005  # relative: kernels of one machine give the same bits, those of two nearly so


def rows_by_key(results):
    return {(r["method"], r["curve"], r["setting"], r["device"], r["set"], r["scene"], r["video"]): r
            for r in results["rows"]}


def disturbance(before, after):
    """How much slower the second machine was at what no change of ours can have touched: the median ratio of processor
    times of peers. 1 where there are none in common."""
    old, new = rows_by_key(before), rows_by_key(after)
    family = after["methods"]
    ratios = [new[k]["wall_ms"][1] / old[k]["wall_ms"][1] for k in old.keys() & new.keys()
              if family.get(k[0], {}).get("family") == "peer" and old[k]["wall_ms"] and new[k]["wall_ms"]]
    return summary.statistics.median(ratios) if len(ratios) >= 5 else 1.0


def compare(before, after):
    """Lines of text, worst first, and a last line that counts."""
    old, new = rows_by_key(before), rows_by_key(after)
    machine = disturbance(before, after)
    found = []
    for key in old.keys() & new.keys():
        a, b = old[key], new[key]
        name = f"{key[0]} {key[1]}={key[2]} on {key[4]}/{key[5]} ({key[3]})"
        for time in ("wall_ms", "device_ms"):
            if not a[time] or not b[time] or key[3] == "processor":
                continue
            ratio = b[time][1] / a[time][1] / machine
            apart = b[time][0] > a[time][2] * machine or b[time][2] < a[time][0] * machine
            if apart and abs(ratio - 1) > TIME_FLOOR:
                found.append((ratio, f"{name}: {time[:-3]} time × {ratio:.2f} "
                                     f"({a[time][1]:.2f} → {b[time][1]:.2f} ms)"))
        for error in ("lmse20", "mse", "dssim", "whdr", "to_converged", "flicker", "jitter"):
            x, y = a.get(error), b.get(error)
            if x is None or y is None or max(x, y) < 1e-6:
                continue
            ratio = y / x if x > 0 else float("inf")
            if abs(ratio - 1) > ERROR_FLOOR and abs(x - y) > 1e-4:
                found.append((ratio, f"{name}: {error} {x:.4f} → {y:.4f} (× {ratio:.3f})"))
    worse = [line for ratio, line in sorted(found, reverse=True) if ratio > 1]
    better = [line for ratio, line in sorted(found) if ratio < 1]
    lines = [f"settings and scenes in common: {len(old.keys() & new.keys())}; only before: {len(old.keys() - new.keys())}; "
             f"only now: {len(new.keys() - old.keys())}",
             f"the machine takes {machine:.2f} of the time that it took then (median of the peers); "
             "ratios of times are corrected for that"]
    lines += ["worse:"] + [f"  {line}" for line in worse] + ["better:"] + [f"  {line}" for line in better]
    lines.append(f"{len(worse)} worse, {len(better)} better; the rest is the same within the noise")
    return lines
