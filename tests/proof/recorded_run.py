"""Queries of a recorded run's folder: the numbers that a documentation page quotes are computed by these again."""

import csv
import functools
import json
import pathlib


class Run:
    """The results of `koboshi run --out FOLDER`. Times in s; values in the units of the header of trace.csv."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    @functools.cached_property
    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    @functools.cached_property
    def _columns(self):
        with (self.folder / "trace.csv").open(newline="") as file:
            rows = csv.reader(file)
            names = next(rows)
            return dict(zip(names, zip(*rows)))

    @functools.cached_property
    def times_s(self):
        return [float(time) for time in self._columns["time_s"]]

    def signal(self, name, begin_s=0.0, end_s=float("inf")):
        """Returns the (time, value) pairs of a column between two times, without those that have no value."""
        return [(time, float(value)) for time, value in zip(self.times_s, self._columns[name])
                if begin_s <= time <= end_s and value not in ("", "nan")]

    def at(self, name, time_s):
        """Returns the value of a column in the sample nearest to a time."""
        return min(self.signal(name), key=lambda sample: abs(sample[0] - time_s))[1]

    def largest(self, name, begin_s=0.0, end_s=float("inf")):
        return max(value for _, value in self.signal(name, begin_s, end_s))

    def smallest(self, name, begin_s=0.0, end_s=float("inf")):
        return min(value for _, value in self.signal(name, begin_s, end_s))

    def time_of_largest(self, name, begin_s=0.0, end_s=float("inf")):
        return max(self.signal(name, begin_s, end_s), key=lambda sample: sample[1])[0]

    def first_time(self, name, condition, begin_s=0.0):
        """Returns the time of the first sample from begin_s on whose value fulfils the condition."""
        return next(time for time, value in self.signal(name, begin_s) if condition(value))

    def events(self, kind):
        return [event for event in self.summary["events"] if event["kind"] == kind]

    def event_s(self, kind):
        """Returns the time of the first event of a kind."""
        return self.events(kind)[0]["t_s"]

    @property
    def verdict(self):
        return self.summary["verdict"]

    def first_difference_s(self, other):
        """Returns the time of the first sample in which a column of two runs differs."""
        names = self._columns.keys() & other._columns.keys()
        for row, time in enumerate(self.times_s):
            if any(self._columns[name][row] != other._columns[name][row] for name in names):
                return time
        raise ValueError("the runs do not differ")
