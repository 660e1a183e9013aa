#include "pipeline/pose_file.h"

#include <Eigen/Geometry>
#include <numbers>

#include "common/config.h"
#include "common/file.h"
#include "pipeline/region_settings.h"

namespace vivify::pipeline {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Schema handle_schema() {
  return object("Takes hold of a part of the body and scales it, turns it and moves it, in this order.")
      .field("region", region_schema().required())
      .field("pin", boolean("Holds the part where it is.").initially(false))
      .field("move", vector("How far it is moved.", 3).unit("m").initially({0, 0, 0}))
      .field("rotate_deg",
             number("How far it is turned; more than 360 winds the body up.").unit("deg").initially(0.0))
      .field("axis", vector("Axis of the turn, of any length. Bodies of the plane turn about z.", 3)
                         .initially({0, 1, 0}))
      .field("scale", vector("Factors along x, y and z.", 3).initially({1, 1, 1}))
      .field("about", about_schema());
}

bool moves(const Value& handle) {
  return handle["rotate_deg"].as_number() != 0 || !handle["move"].as_vector3().isZero(0) ||
         handle["scale"].as_vector3() != Eigen::Vector3d::Ones();
}

void check_handle(const Value& handle, const std::string& name, std::vector<Error>& errors) {
  const auto fail = [&](const Value& at, const std::string& message, const std::string& hint) {
    errors.emplace_back(ErrorKind::usage, name + message, hint, at.where());
  };
  if (handle["pin"].as_bool() && moves(handle)) {
    fail(handle["pin"], ".pin holds a part that is also moved", "remove `pin`, or the motion");
  }
  if (!handle["pin"].as_bool() && !moves(handle)) {
    fail(handle, " does nothing", "give it `move`, `rotate_deg` or `scale`, or `pin: true`");
  }
  if (!(handle["scale"].as_vector3().minCoeff() > 0)) {
    fail(handle["scale"], ".scale must be > 0 along every axis", "");
  }
  if (handle["axis"].as_vector3().isZero(0)) fail(handle["axis"], ".axis has no length", "");
  check_region(handle, name, errors);
}

sim::PoseHandle make_handle(const Value& item, const std::string& name) {
  sim::PoseHandle handle;
  handle.region = make_region(item, name);
  handle.move = item["move"].as_vector3();
  handle.angle = item["rotate_deg"].as_number() * kDegree;
  handle.axis = item["axis"].as_vector3();
  handle.scale = item["scale"].as_vector3();
  if (item.has("about")) handle.about = item["about"].as_vector3();
  return handle;
}

std::string handle_name(std::size_t i) { return "handles[" + std::to_string(i) + "]"; }

}  // namespace

Schema pose_schema() {
  return object("A pose of a body, for `vivify pose` and for examples of a rest space.")
      .field("version", integer("Version of the pose format.").at_least(1).at_most(1).required())
      .field("scene", path("Scene of the body, relative to the pose file. Only `vivify pose` needs it."))
      .field("body", string("Name of the body in the scene. Left out: its only body."))
      .field("gravity", boolean("Whether the gravity of the scene acts.").initially(false))
      .field("handles", list("What takes hold of the body.", handle_schema()).items_at_least(1).required());
}

Value load_pose(const std::filesystem::path& file, std::vector<Error>& errors) {
  const std::size_t before = errors.size();
  const ConfigNode root = parse_yaml(read_text_file(file), file.string(), errors);
  Value pose = resolve(pose_schema(), root, errors);
  if (errors.size() > before) return pose;
  const std::vector<Value>& handles = pose["handles"].items();
  for (std::size_t i = 0; i < handles.size(); ++i) check_handle(handles[i], handle_name(i), errors);
  return pose;
}

sim::PoseSolution solve_pose(const Value& pose, const SimMesh& rest, const Value& model,
                             const Eigen::Vector3d& gravity) {
  const std::vector<Value>& items = pose["handles"].items();
  std::vector<sim::PoseHandle> handles;
  for (std::size_t i = 0; i < items.size(); ++i) handles.push_back(make_handle(items[i], handle_name(i)));
  try {
    return sim::solve_pose(rest, model, handles,
                           pose["gravity"].as_bool() ? gravity : Eigen::Vector3d::Zero().eval());
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    Location where = pose["handles"].where();
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (std::string(error.what()).starts_with(handle_name(i))) where = items[i].where();
    }
    throw Error(error.kind(), error.what(), error.hint(), where);
  }
}

Points in_asset_coordinates(const RowMatrixXd& V, const Value& body) {
  Points spatial = Points::Zero(V.rows(), 3);
  spatial.leftCols(V.cols()) = V;
  Eigen::RowVector3d position = body["position"].as_vector3().transpose();
  if (V.cols() == 2) position.z() = 0;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(body["heading_deg"].as_number() * kDegree, Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  return ((spatial.rowwise() - position) * turn) / body["scale"].as_number();
}

}  // namespace vivify::pipeline
