// rosefusion export: a result for other programs.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>

#include "apps/cli/commands.h"
#include "apps/cli/export_texture.h"
#include "apps/cli/export_views.h"
#include "apps/cli/validators.h"
#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/export/decimation.h"
#include "host/export/mesh_formats.h"
#include "host/export/mesh_io.h"
#include "host/export/pose_formats.h"
#include "host/export/upright.h"
#include "host/run/result.h"

namespace rosefusion::cli {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  std::string result;
  std::vector<std::string> to;
  std::string as;
  double max_error = 0;  ///< metres; 0: as it is
  std::size_t triangles = 0;
  std::string up;
  std::vector<double> up_is;
  std::string recording;
  bool texture = false;
  int texture_size = 4096;  ///< texels
};

/// What a file is written as, by its ending where --as does not say.
std::string formatOf(const fs::path& file, const std::string& as) {
  if (!as.empty()) return as;
  static const std::map<std::string, std::string> kEndings = {
      {".glb", "glb"},  {".obj", "obj"}, {".ply", "ply"},    {".html", "page"},
      {".htm", "page"}, {".tum", "tum"}, {".kitti", "kitti"}};
  const auto found = kEndings.find(lowered(file.extension().string()));
  if (found != kEndings.end()) return found->second;
  throw InputError(file.string() +
                   ": its ending names no format; end it in .glb, .obj, .ply, .html, .tum or .kitti, or say "
                   "what it is to be with --as.");
}

class Exporter {
 public:
  explicit Exporter(const ExportArguments& o) : o_(o), result_(readResult(o.result)) {
    const auto takesTexture = [&](const std::string& file) {
      const std::string format = formatOf(file, o.as);
      return format == "glb" || format == "obj";
    };
    if (o.texture && std::none_of(o.to.begin(), o.to.end(), takesTexture))
      throw InputError("--texture: only .glb and .obj have textures; give --to a file that ends so.");
  }

  void write(const fs::path& file) {
    const std::string format = formatOf(file, o_.as);
    requireOtherThanResult(file);
    if (format == "nerfstudio" || format == "colmap")
      exportViews(result_, o_.recording, file,
                  format == "colmap" ? ViewFormat::Colmap : ViewFormat::Nerfstudio);
    else if (format == "page")
      writeFileAtomically(
          file, pageOf(pageContentOf(settledPath(o_.result).filename().string(),
                                     hasMesh() ? mesh() : TriangleMesh(), result_.frames, result_.camera)));
    else if (format == "tum" || format == "kitti")
      writePoses(file, format);
    else
      writeSurface(file, format);
    std::printf("  %s\n", file.c_str());
  }

 private:
  fs::path meshFile() const { return fs::path(o_.result) / "mesh.ply"; }
  bool hasMesh() const { return fs::is_regular_file(meshFile()); }
  const TriangleMesh& mesh() {
    if (mesh_.triangles.empty()) mesh_ = readMesh(meshFile());
    return mesh_;
  }

  /// What a result is made of is not overwritten with something else.
  void requireOtherThanResult(const fs::path& file) const {
    std::error_code error;
    for (const char* own : {"mesh.ply", "trajectory.txt", "frames.csv", "report.json", "settings.yaml"})
      if (fs::equivalent(file, fs::path(o_.result) / own, error))
        throw InputError(file.string() + ": is part of the result itself; choose another name.");
  }

  /// `usual`: where --up says nothing.
  Eigen::Matrix3d rotation(const std::string& usual) {
    const std::string up = o_.up.empty() ? usual : o_.up;
    const UpAxis axis = up == "y" ? UpAxis::Y : up == "z" ? UpAxis::Z : UpAxis::Keep;
    if (axis == UpAxis::Keep) return Eigen::Matrix3d::Identity();
    if (!o_.up_is.empty()) {
      const Eigen::Vector3d given(o_.up_is[0], o_.up_is[1], o_.up_is[2]);
      if (given.norm() < 1e-9) throw InputError("--up-is: is no direction; give three numbers, not all 0.");
      return rotationToAxis(given.normalized(), axis);
    }
    std::vector<Pose> poses;
    for (const PageFrame& frame : result_.frames)
      if (frame.placed) poses.push_back(frame.world_from_camera);
    const Eigen::Vector3d held = meanUp(poses);
    const auto floor = hasMesh() ? floorNormal(mesh(), held) : std::nullopt;
    if (!floor && !warned_)
      spdlog::warn(
          "{}: no floor is clear in it; up is what the cameras had for up. Say it with --up-is X,Y,Z.",
          o_.result);
    warned_ = !floor;
    return rotationToAxis(floor.value_or(held), axis);
  }

  void writePoses(const fs::path& file, const std::string& format) {
    Pose turned = Pose::Identity();
    turned.linear() = rotation("keep");
    Trajectory trajectory;
    std::vector<Pose> poses;
    for (const PageFrame& frame : result_.frames) {
      if (!frame.placed) continue;
      trajectory.push_back({frame.seconds, turned * frame.world_from_camera});
      poses.push_back(trajectory.back().world_from_camera);
    }
    if (poses.empty()) throw InputError(o_.result + ": has no frame with a pose.");
    if (format == "tum")
      writeTumTrajectory(file, trajectory);
    else
      writeFileAtomically(file, kittiOf(poses));
  }

  void writeSurface(const fs::path& file, const std::string& format) {
    TriangleMesh surface = mesh();
    const std::size_t before = surface.triangles.size();
    if (o_.max_error > 0 || o_.triangles > 0)
      surface = decimated(surface, {o_.max_error > 0 ? o_.max_error : 1e3, o_.triangles});
    if (o_.texture && format != "ply") return writeTextured(file, format, surface);
    turn(surface, rotation(format == "glb" ? "y" : "keep"));
    if (format == "glb")
      writeFileAtomically(file, glbOf(surface));
    else if (format == "obj")
      writeFileAtomically(file, objOf(surface));
    else
      writePly(file, surface);
    std::printf("%zu of %zu triangles:", surface.triangles.size(), before);
  }

  void writeTextured(const fs::path& file, const std::string& format, const TriangleMesh& surface) {
    if (!textured_) {
      requireWritable(file);
      textured_ = texturedResult(result_, surface, o_.recording, o_.texture_size);
    }
    TexturedMesh turned = *textured_;
    turn(turned.mesh, rotation(format == "glb" ? "y" : "keep"));
    if (format == "glb")
      writeFileAtomically(file, glbOf(turned));
    else
      writeTexturedObj(file, turned);
    std::printf(
        "%zu triangles, texture of %d x %d from %zu images, %zu pieces, %zu triangles that none sees:",
        turned.mesh.triangles.size(), turned.texture.cols, turned.texture.rows, turned.views, turned.charts,
        turned.unseen);
  }

  const ExportArguments& o_;
  RunResult result_;
  std::optional<TexturedMesh> textured_;
  TriangleMesh mesh_;
  bool warned_ = false;
};

}  // namespace

void addExportCommand(CLI::App& app) {
  auto o = std::make_shared<ExportArguments>();
  CLI::App* command =
      app.add_subcommand("export", "A result for other programs: mesh, poses, images with poses, page");
  command->add_option("RESULT", o->result, "Folder that 'rosefusion run' wrote")->required();
  command
      ->add_option("--to", o->to,
                   "File by its ending: .glb, .obj, .ply, .html, .tum, .kitti; may be repeated")
      ->required()
      ->allow_extra_args(false);
  command
      ->add_option("--as", o->as,
                   "What to write whatever the ending; nerfstudio and colmap write a folder with images")
      ->check(CLI::IsMember({"glb", "obj", "ply", "page", "tum", "kitti", "nerfstudio", "colmap"}));
  command
      ->add_option("--max-error", o->max_error,
                   "Fewer triangles, as long as the surface moves by no more metres")
      ->check(positive());
  command->add_option("--triangles", o->triangles, "Fewer triangles, down to so many")
      ->check(CLI::Range(1, 1000000000));
  command
      ->add_option(
          "--up", o->up,
          "Axis that points up: y, z, or keep the first camera's axes (default: y for .glb, else keep)")
      ->check(CLI::IsMember({"y", "z", "keep"}));
  command
      ->add_option(
          "--up-is", o->up_is,
          "X,Y,Z: what is up in the result's own axes; else the floor's normal, or how cameras were held")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--recording", o->recording,
                      "Where the recording lies now, for --texture, nerfstudio and colmap");
  command->add_flag(
      "--texture", o->texture,
      ".glb and .obj with a texture made of the recording's images, in place of vertex colours");
  command
      ->add_option(
          "--texture-size", o->texture_size,
          "Texels that the texture may be wide and high; it is smaller where the images have no more to show")
      ->check(CLI::Range(256, 16384))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  rosefusion export out/desk --to desk.glb --max-error 0.005\n"
      "  rosefusion export out/desk --to desk.glb --max-error 0.005 --texture\n"
      "  rosefusion export out/desk --to desk.ply --up z --to desk.html\n"
      "  rosefusion export out/desk --to nerf --as nerfstudio    # transforms.json, images/, depth/");
  command->callback([o] {
    Exporter exporter(*o);
    for (const std::string& file : o->to) exporter.write(file);
  });
}

}  // namespace rosefusion::cli
