"""Threads, processes and the interpreter's end. Each case is a program of its own, which must end in order."""
import subprocess
import sys
import textwrap
import unittest

START = """
import os, sys, threading, time
import camera, rosefusion

CAMERA = rosefusion.Camera(320, 240, 160, 160, 159.5, 119.5)
QUICK = {"swarm.levels": "512/8", "tracking.templates_per_level": 3, "volume.voxel_size": 0.06, "volume.truncation": 0.18}
DEPTH = camera.depth_image(0)

def make(**settings):
    return rosefusion.Reconstructor(CAMERA, preset="paper", settings={**QUICK, **settings})

def frames(reconstructor, count=1000000):
    for i in range(count):
        reconstructor.process(DEPTH, i / 30)
"""


class Programs(unittest.TestCase):
    def ends(self, text, said="", code=0, times=1):
        for _ in range(times):
            ended = subprocess.run([sys.executable, "-c", START + textwrap.dedent(text)], capture_output=True, text=True,
                                   timeout=300, check=False)
            self.assertEqual(ended.returncode, code, ended.stderr)
            self.assertEqual(ended.stdout.strip(), said, ended.stderr)

    def test_a_global_one_at_the_end(self):
        self.ends("kept = make(); frames(kept, 2); cycle = [kept]; cycle.append(cycle); sys.kept = cycle; print('end')", "end")

    def test_frames_at_exit(self):
        self.ends("import atexit; kept = make(); atexit.register(frames, kept, 2)")

    def test_threads_that_nobody_waits_for_are_left_in_a_frame(self):
        self.ends("""
            for _ in range(2):
                kept = make()
                frames(kept, 1)
                threading.Thread(target=frames, args=(kept,), daemon=True).start()
            time.sleep(0.2)
            print("end")
            """, "end", times=3)

    def test_threads_that_nobody_waits_for_are_left_in_a_constructor(self):
        self.ends("""
            import logging
            logging.basicConfig(level="INFO", stream=open(os.devnull, "w"))
            def work():
                while True:
                    make(**{"tracker.method": "pst"})  # an old name, which is logged
            threading.Thread(target=work, daemon=True).start()
            time.sleep(0.3)
            print("end")
            """, "end", times=3)

    def test_several_threads_share_one(self):
        self.ends("""
            shared = make()
            threads = [threading.Thread(target=frames, args=(shared, 4)) for _ in range(3)]
            threads += [threading.Thread(target=lambda: [shared.mesh(), shared.trajectory()]) for _ in range(2)]
            for thread in threads: thread.start()
            for thread in threads: thread.join()
            shared.integrate(DEPTH, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], 100.0)
            print(len(shared.trajectory()))
            """, "13")

    def test_what_logging_raises_comes_out_of_the_constructor(self):
        self.ends("""
            import logging
            class Full(logging.Filter):
                def filter(self, record):
                    raise OSError("no room")
            full = Full()
            logging.getLogger("rosefusion").addFilter(full)
            for _ in range(2):
                try: make(**{"tracker.method": "pst"})
                except OSError as error: print(error)
            logging.getLogger("rosefusion").removeFilter(full)
            frames(make(), 1)
            """, "no room\nno room")

    @unittest.skipUnless(hasattr(__import__("os"), "fork"), "there is no fork here")
    def test_children(self):
        self.ends("""
            kept = make()
            frames(kept, 1)
            child = os.fork()
            if child == 0:
                try: frames(kept, 1)
                except rosefusion.Error as error: print("fork()" in str(error), flush=True)
                del kept
                sys.exit(7)
            print(os.waitpid(child, 0)[1] >> 8)
            frames(kept, 1)
            import multiprocessing
            def statuses(_):
                return str(make().process(DEPTH, 0.0).status)
            with multiprocessing.get_context("fork").Pool(2) as pool:
                print(set(pool.map(statuses, range(4))))
            """, "True\n7\n{'Status.TRACKED'}")


if __name__ == "__main__":
    unittest.main(verbosity=2)
