"""The Python module: the README of host/public's quickstart as it stands there, then what it leaves out. test_python.py README STUBS"""
import ast
import locale
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np

import camera
import rosefusion

README = sys.argv.pop(1)
STUBS = sys.argv.pop(1)
CAMERA = rosefusion.Camera(320, 240, 160, 160, 159.5, 119.5)
QUICK = {"swarm.levels": "1024/16 512/8 256/4", "tracking.templates_per_level": 3, "volume.voxel_size": 0.03,
         "volume.truncation": 0.09}


def reconstructor():
    return rosefusion.Reconstructor(CAMERA, preset="paper", settings=QUICK)


class Quickstart(unittest.TestCase):
    def test_the_readmes_text_runs(self):
        with open(README) as file:
            text = re.search(r"^```python\n(.*?)^```$", file.read(), re.MULTILINE | re.DOTALL).group(1)
        names = {}
        exec(text, names)
        position = names["result"].world_from_camera[:3, 3]
        truth = camera.STEP * (camera.FRAMES - 1)
        np.testing.assert_allclose(position, [truth, 0, 0], atol=0.01)
        self.assertGreater(len(names["mesh"].triangles), 5000)


class Stubs(unittest.TestCase):
    """rosefusion.pyi names what there is, and nothing else."""

    @classmethod
    def setUpClass(cls):
        with open(STUBS) as file:
            cls.tree = ast.parse(file.read())

    def test_names_and_members(self):
        told = {node.name for node in self.tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        told |= {target.id for node in self.tree.body if isinstance(node, ast.Assign) for target in node.targets}
        self.assertEqual(told, {name for name in vars(rosefusion) if not name.startswith("_")})
        for node in self.tree.body:
            if not isinstance(node, ast.ClassDef) or node.name == "Error":
                continue
            members = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
            members |= {part.target.id for part in node.body if isinstance(part, ast.AnnAssign)}
            public = {name for name in members if not name.startswith("_")}
            there = {name for name in vars(getattr(rosefusion, node.name)) if not name.startswith("_")}
            self.assertEqual(public, there, node.name)

    def test_arguments(self):
        compared = 0
        functions = [("", node) for node in self.tree.body if isinstance(node, ast.FunctionDef)]
        functions += [(node.name, part) for node in self.tree.body if isinstance(node, ast.ClassDef)
                      for part in node.body if isinstance(part, ast.FunctionDef)]
        for owner, node in functions:
            holder = getattr(rosefusion, owner) if owner else rosefusion
            document = getattr(holder, node.name).__doc__ or ""
            told = [argument.arg for argument in node.args.args if argument.arg != "self"]
            signatures = re.findall(rf"\b{node.name}\((.*)\) ->", document)
            if node.name.startswith("__") and node.name != "__init__" or not told or not signatures or owner == "Status":
                continue
            real = [re.findall(r"(\w+): ", re.sub(r"\[[^][]*\]", "", text.replace("self: ", ""))) for text in signatures]
            self.assertIn(told, real, f"{owner}.{node.name}")
            compared += 1
        self.assertGreaterEqual(compared, 5)


class ForeignLocale(unittest.TestCase):
    """Decimal commas and Turkish letters, as the locale of a desktop program."""

    def test_pipelines_work_in_every_locale(self):
        for name in ("de_DE", "tr_TR"):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                full = name + ".UTF-8"
                made = subprocess.run(["localedef", "-i", name, "-f", "UTF-8", os.path.join(folder, full)],
                                      capture_output=True, check=False) if shutil.which("localedef") else None
                if made is None or made.returncode != 0:
                    self.skipTest("localedef cannot make %s; install locales (Debian) to run this." % name)
                with mock.patch.dict(os.environ, LOCPATH=folder):
                    locale.setlocale(locale.LC_ALL, full)
                    try:
                        self.assertEqual(locale.localeconv()["decimal_point"], ",")
                        r = reconstructor()
                        for seconds, depth in list(camera.frames())[:2]:
                            self.assertNotEqual(r.process(depth, seconds).status, rosefusion.Status.LOST)
                    finally:
                        locale.setlocale(locale.LC_ALL, "C")


class Module(unittest.TestCase):
    def test_the_old_names_still_work(self):
        camera_too = rosefusion.Intrinsics(320, 240, 160, 160, 159.5, 119.5)
        p = rosefusion.Pipeline(intrinsics=camera_too, preset="paper", settings=QUICK)
        self.assertIsInstance(p, rosefusion.Reconstructor)

    def test_arrays_have_their_shapes_and_types(self):
        p = reconstructor()
        for seconds, depth in list(camera.frames())[:3]:
            result = p.process(depth, seconds)
            self.assertNotEqual(result.status, rosefusion.Status.LOST, result.reason)
        self.assertEqual(result.world_from_camera.shape, (4, 4))
        np.testing.assert_allclose(result.world_from_camera[3], [0, 0, 0, 1])
        mesh = p.mesh()
        self.assertEqual(mesh.vertices.shape[1], 3)
        self.assertEqual(mesh.vertices.dtype, np.float32)
        self.assertEqual(mesh.normals.shape, mesh.vertices.shape)
        self.assertEqual(mesh.triangles.dtype, np.uint32)
        self.assertLess(mesh.triangles.max(), len(mesh.vertices))
        # The ball's nearest point, seen from the first frame: the mesh is in metres and in the right order.
        distance = np.linalg.norm(mesh.vertices - [0.3, 0.2, 1.8], axis=1)
        self.assertLess(abs(distance[mesh.vertices[:, 2] < 1.7].min() - 0.4), 0.03)
        self.assertEqual(len(p.trajectory()), 3)
        np.testing.assert_array_equal(p.trajectory()[2][1], result.world_from_camera)

    def test_known_poses_and_colour(self):
        p = reconstructor()
        pose = np.eye(4)
        pose[:3, 3] = [1, 2, 3]
        red = np.zeros((240, 320, 3), np.uint8)
        red[..., 0] = 200
        p.integrate(camera.depth_image(0), pose, 0.0, red)
        result = p.process(camera.depth_image(camera.STEP), 1 / 30)
        np.testing.assert_allclose(result.world_from_camera[:3, 3], [1 + camera.STEP, 2, 3], atol=0.03)
        self.assertGreater(np.median(p.mesh().colours[:, 0]), 150)
        self.assertLess(np.median(p.mesh().colours[:, 2]), 50)

    def test_the_motion_of_another_sensor_is_read(self):
        p = reconstructor()
        for seconds, depth in list(camera.frames())[:2]:
            result = p.process(depth, seconds, motion=np.eye(3))
        self.assertNotEqual(result.status, rosefusion.Status.LOST)
        with self.assertRaisesRegex(rosefusion.Error, "rigid"):
            p.process(camera.depth_image(0.06), 0.1, motion=2 * np.eye(3))
        with self.assertRaisesRegex(ValueError, "4 x 4"):
            p.process(camera.depth_image(0.06), 0.1, motion=np.eye(2))

    def test_a_column_slice_is_read_as_it_looks(self):
        wide = np.zeros((240, 640), np.uint16)
        wide[:, ::2] = camera.depth_image(0)
        p = reconstructor()
        self.assertEqual(p.process(np.ascontiguousarray(wide[:, ::2]), 0.0).status, rosefusion.Status.TRACKED)

    def test_what_the_library_says_goes_to_logging(self):
        with tempfile.TemporaryDirectory() as empty, mock.patch.dict(os.environ, XDG_CACHE_HOME=empty):
            with self.assertLogs("rosefusion", "INFO") as log:
                reconstructor()
        self.assertIn("templates", log.output[0])

    def test_mistakes_are_refused_in_words(self):
        p = reconstructor()
        with self.assertRaisesRegex(ValueError, "240 x 320"):
            p.process(np.zeros((320, 240), np.uint16), 0.0)
        with self.assertRaises(TypeError):
            p.process(np.zeros((240, 320), np.float32), 0.0)
        with self.assertRaisesRegex(ValueError, "4 x 4"):
            p.integrate(camera.depth_image(0), np.eye(3), 0.0)
        with self.assertRaisesRegex(rosefusion.Error, "volume.voxel_size"):
            rosefusion.Reconstructor(CAMERA, settings={"volume.voxel_sise": 0.01})


@unittest.skipUnless(hasattr(rosefusion, "load"), "this build has no recordings")
class Recordings(unittest.TestCase):
    FOLDER = os.path.join(os.path.dirname(__file__), "..", "..", "fixtures", "recordings")

    def test_frames_camera_and_truth(self):
        for name in ("small.bag", "small.sens", "small.r3d"):
            with self.subTest(name):
                recording = rosefusion.load(os.path.join(self.FOLDER, name))
                self.assertEqual(len(recording), 3)
                self.assertAlmostEqual(recording.camera.fx, 30)
                frames = list(recording)
                self.assertAlmostEqual(frames[2].timestamp, 10.2)
                v, u = np.mgrid[:24, :32]
                metres = frames[1].depth / recording.camera.depth_units_per_metre
                known = frames[1].depth > 0
                self.assertGreaterEqual(known.sum(), 24 * 32 - 1)
                np.testing.assert_allclose(metres[known], ((1501 + u + 40 * v) / 1000)[known], atol=1e-4)
                np.testing.assert_allclose(frames[0].rgb[5, 5], [200, 20, 10], atol=3)
                self.assertIs(rosefusion.load(os.path.join(self.FOLDER, name), colour=False)[-1].rgb, None)
        np.testing.assert_allclose(rosefusion.load(os.path.join(self.FOLDER, "small.sens")).truth[1][1][:3, 3],
                                   [0.5, -0.25, 2])

    def test_what_cannot_be_opened_is_named(self):
        with self.assertRaisesRegex(rosefusion.Error, "/nowhere"):
            rosefusion.load("/nowhere")
        with self.assertRaises(IndexError):
            rosefusion.load(os.path.join(self.FOLDER, "small.bag"))[3]


if __name__ == "__main__":
    unittest.main(verbosity=2)
