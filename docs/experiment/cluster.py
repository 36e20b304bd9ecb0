"""How long a job array takes on many cores: simulates a queue, for docs/experiment/cluster.md.

Usage: cluster.py [--trials N] [--cores N] [--trial-s S] [--start-s S] [--starts-per-s N] [--failures-per-core-h N]

Each shard is a task of the array. The scheduler starts so many tasks a second on free cores. A task needs some time before its first trial;
its trials then last as long as measured on one core, give or take. Cores fail at random: their task is queued again after two minutes, as
Slurm does it, and plays only what its file lacks.
"""

import argparse
import heapq
import math
import random

REQUEUE_s = 121.0  # Slurm's delay before a task that was requeued may start


def shard_trials(trials, shards):
    """Returns the number of trials of each shard, as lab/cluster/shard.cc divides them."""
    return [trials * (k + 1) // shards - trials * k // shards for k in range(shards)]


def duration_s(count, options, rng):
    """Returns how long so many trials last: their sum is close to normal, and the speed of the core differs by some percent."""
    mean = count * options.trial_s
    spread = math.sqrt(count) * options.trial_s * options.trial_variation
    return max(0.0, rng.gauss(mean, spread)) * rng.gauss(1.0, options.core_variation)


def simulate(shards, options, seed=1):
    """Returns the seconds until the last shard is complete, the share of core time that trials had, and the number of failures."""
    rng = random.Random(seed)
    waiting = [(0.0, shard, count) for shard, count in enumerate(shard_trials(options.trials, shards))]  # by the time from which it may start
    heapq.heapify(waiting)
    cores = [0.0] * min(options.cores, shards)  # when each is free
    heapq.heapify(cores)
    next_start = busy = end = 0.0
    failures = 0
    while waiting:
        eligible, shard, count = heapq.heappop(waiting)
        start = max(eligible, heapq.heappop(cores), next_start)
        next_start = start + 1.0 / options.starts_per_s
        needed = duration_s(count, options, rng)
        lives = rng.expovariate(options.failures_per_core_h / 3600.0) if options.failures_per_core_h > 0.0 else math.inf
        played = min(needed, max(0.0, lives - options.start_s))
        free = start + options.start_s + played
        busy += played
        heapq.heappush(cores, free)
        end = max(end, free)
        if played < needed:
            failures += 1
            left = math.ceil(count * (1.0 - played / needed))  # the trial under way is lost
            heapq.heappush(waiting, (free + REQUEUE_s, shard, left))
    return end, busy / (end * options.cores), failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--trials", type=int, default=1_000_000)
    parser.add_argument("--cores", type=int, default=1000)
    parser.add_argument("--trial-s", type=float, default=0.30, help="mean wall time of a trial on one core")
    parser.add_argument("--trial-variation", type=float, default=0.5, help="standard deviation of a trial's time, as a share of its mean")
    parser.add_argument("--core-variation", type=float, default=0.05, help="of the cores' speed")
    parser.add_argument("--start-s", type=float, default=0.5, help="from the start of a task to its first trial")
    parser.add_argument("--starts-per-s", type=float, default=50.0, help="tasks that the scheduler starts in a second")
    parser.add_argument("--failures-per-core-h", type=float, default=1e-3)
    parser.add_argument("--shards", default="100,1000,2000,5000,10000,50000,100000")
    options = parser.parse_args()
    ideal_s = options.trials * options.trial_s / options.cores
    print(f"{options.trials} trials of {options.trial_s} s on {options.cores} cores; at best {ideal_s / 60:.1f} min")
    print("| shards | trials of a shard | minutes | of the best | cores busy | failures |")
    print("| ---: | ---: | ---: | ---: | ---: | ---: |")
    for shards in (int(text) for text in options.shards.split(",")):
        end_s, share, failures = simulate(shards, options)
        print(f"| {shards} | {options.trials / shards:.0f} | {end_s / 60:.1f} | {end_s / ideal_s:.2f} | {100 * share:.0f} % | {failures} |")


if __name__ == "__main__":
    main()
