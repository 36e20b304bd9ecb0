"""compare_heard.py TIMING HEARD: checks that the listener received as many frames as the run's timing.json reports as sent."""

import json
import sys

timing = json.load(open(sys.argv[1]))
live, can, heard = timing["live"], timing["live"]["can"], int(sys.argv[2])
print(f"{can['frames_sent']} frames sent, {can['frames_lost']} without room, {heard} heard; {timing['wall_s']:.1f} s of wall time, "
      f"{live['overruns']} times late, {live['largest_delay_us'] / 1000:.0f} ms at most")
sys.exit(can["frames_lost"] != 0 or heard != can["frames_sent"] or heard == 0)
