#include "pipeline/handle_settings.h"

#include "common/text.h"
#include "pipeline/motion_settings.h"
#include "pipeline/region_settings.h"

namespace vivify::pipeline {
namespace {

constexpr double kSamePlace = 1e-9;  // m, and of a turn

sim::RigidPath handle_path(const Value& handle, const std::string& where) {
  return motion_path(handle, where, "move", Eigen::Vector3d::Zero());
}

class HandleCheck {
 public:
  HandleCheck(const Value& handle, std::string where, double spawn, std::vector<Error>& errors)
      : handle_(handle), where_(std::move(where)), spawn_(spawn), errors_(errors) {}

  void run(bool planar) {
    const std::size_t before = errors_.size();
    check_region(handle_, where_, errors_);
    check_motion(handle_, where_, errors_);
    if (planar) plane();
    if (handle_.has("until_s") && !(handle_["until_s"].as_number() > spawn_)) {
      fail(handle_["until_s"],
           ".until_s = " + number_text(handle_["until_s"].as_number()) +
               " s is not after the body appears, at " + number_text(spawn_) + " s",
           "let go later");
    }
    if (errors_.size() > before) return;
    try {
      start(handle_path(handle_, where_).pose(spawn_));
    } catch (const Error& error) {
      errors_.push_back(error);
    }
  }

 private:
  void fail(const Value& value, const std::string& message, const std::string& hint) {
    errors_.emplace_back(ErrorKind::usage, where_ + message, hint, value.where());
  }

  void plane() {
    const std::vector<Value>& keys = handle_["motion"].items();
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::string key = ".motion[" + std::to_string(i) + "]";
      if (!keys[i]["rotation_deg"].as_vector3().head<2>().isZero(0)) {
        fail(keys[i]["rotation_deg"], key + ".rotation_deg turns out of the plane, where the body cannot go",
             "only the third angle, about z, may differ from 0");
      }
      if (keys[i]["move"].as_vector3().z() != 0) {
        fail(keys[i]["move"], key + ".move leads out of the plane, where the body cannot go",
             "its third component must be 0");
      }
    }
  }

  // The body is not torn to somewhere else when it appears.
  void start(const Eigen::Isometry3d& pose) {
    if (pose.translation().norm() <= kSamePlace && pose.linear().isIdentity(kSamePlace)) return;
    fail(handle_["motion"], ".motion does not begin where the body is",
         "at " + number_text(spawn_) + " s let `move` and `rotation_deg` be 0");
  }

  const Value& handle_;
  std::string where_;
  double spawn_;  // when the body appears, s
  std::vector<Error>& errors_;
};

std::string name_of(const std::string& body, std::size_t i) {
  return body + ".handles[" + std::to_string(i) + "]";
}

}  // namespace

Schema handle_schema() {
  Schema handle =
      object(
          "Takes hold of a part of the body, whatever pulls at it, and moves it. Without `motion` it is a "
          "pin.")
          .field("region", region_schema().required())
          .field("about", about_schema());
  return add_motion(std::move(handle), "part", "move",
                    vector("How far it is from where it was at first.", 3).unit("m").initially({0, 0, 0}),
                    "Turns about the x, then the y, then the z axis of the world. Bodies of the plane turn "
                    "about z only.")
      .field("until_s", number("When it lets go. Left out: never.").unit("s"));
}

void check_handles(const Value& body, const std::string& where, bool planar, std::vector<Error>& errors) {
  const std::vector<Value>& handles = body["handles"].items();
  for (std::size_t i = 0; i < handles.size(); ++i) {
    HandleCheck(handles[i], name_of(where, i), body["spawn_s"].as_number(), errors).run(planar);
  }
}

std::vector<sim::Handle> make_handles(const Value& body, const std::string& where) {
  const std::vector<Value>& items = body["handles"].items();
  std::vector<sim::Handle> handles;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string name = name_of(where, i);
    sim::Handle handle{make_region(items[i], name), {}, handle_path(items[i], name)};
    if (items[i].has("about")) handle.about = items[i]["about"].as_vector3();
    if (items[i].has("until_s")) handle.until = items[i]["until_s"].as_number();
    handles.push_back(std::move(handle));
  }
  return handles;
}

}  // namespace vivify::pipeline
