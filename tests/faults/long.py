"""long.py disk|stream FRAMES COMMAND..., or long.py library FRAMES SEQUENCE: for long.sh, whose head says what for."""
import csv
import os
import re
import subprocess
import sys

HOW, FRAMES = sys.argv[1], int(sys.argv[2])
MOST_MB, MOST_FILES, MOST_TIME = 1.0, 1.0, 0.1  # per 1,000 frames; a run keeps half a kB a frame for its files


def measure(pid):
    with open(f"/proc/{pid}/status") as status:
        memory = next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))
    with open(f"/proc/{pid}/stat") as stat:
        ticks = sum(int(field) for field in stat.read().rsplit(")", 1)[1].split()[11:13])
    return memory / 1000, len(os.listdir(f"/proc/{pid}/fd")), 1000 * ticks / os.sysconf("SC_CLK_TCK")


def slope(points):
    """Of a straight line through points (frame, value), for 1,000 frames; and the mean value."""
    n = len(points)
    mean_x, mean_y = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    below = sum((x - mean_x) ** 2 for x, _ in points)
    return 1000 * sum((x - mean_x) * (y - mean_y) for x, y in points) / below, mean_y


def program(command):
    """Samples while it runs: frame, MB, files, milliseconds of processor time so far."""
    samples = []
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as run:
        said = []
        for line in run.stderr:
            said.append(line)
            if at := re.match(r"(\d+)(?:/\d+)? frames", line):
                samples.append((int(at[1]), *measure(run.pid)))
    if run.returncode != 0:
        sys.exit(f"long: {HOW}: exit code {run.returncode}: {''.join(said[-3:])}")
    with open(os.path.join(command[command.index("--out") + 1], "frames.csv")) as file:
        rows = list(csv.DictReader(file))
    lost = sum(row["status"] == "lost" for row in rows)
    if len(rows) != FRAMES or lost:
        sys.exit(f"long: {HOW}: {len(rows)} frames, {lost} lost")
    return samples


def library(sequence):
    import rosefusion
    recording = rosefusion.load(sequence)
    images = [frame.depth for frame in recording]
    images += images[-2:0:-1]
    reconstructor = rosefusion.Reconstructor(recording.camera)
    samples = []
    for i in range(FRAMES):
        if reconstructor.process(images[i % len(images)], i / 30).status == rosefusion.Status.LOST:
            sys.exit(f"long: {HOW}: lost at frame {i}")
        if i % 500 == 0:
            reconstructor.mesh()
        if i % 25 == 0:
            samples.append((i, *measure(os.getpid())))
    return samples


samples = library(sys.argv[3]) if HOW == "library" else program(sys.argv[3:])
stands = FRAMES // 3
samples = [s for s in samples if s[0] > stands]
if len(samples) < 5:
    sys.exit(f"long: {HOW}: only {len(samples)} samples; run more frames")
more_mb, _ = slope([(s[0], s[1]) for s in samples])
more_files, files = slope([(s[0], s[2]) for s in samples])
times = [(b[0], (b[3] - a[3]) / (b[0] - a[0])) for a, b in zip(samples, samples[1:]) if b[0] > a[0]]
more_time, mean_time = slope(times)
print(f"long: {HOW}, {FRAMES} frames: {more_mb:+.2f} MB, {more_files:+.2f} files, {more_time:+.2f} ms of processor time a frame per 1,000 frames; "
      f"{files:.0f} files, {mean_time:.1f} ms; MB by fifths:", *(f"{samples[len(samples) * i // 5][1]:.1f}" for i in range(5)),
      f"{samples[-1][1]:.1f}")
if more_mb > MOST_MB or more_files > MOST_FILES or more_time > MOST_TIME * mean_time:
    sys.exit(f"long: {HOW}: it grows")
