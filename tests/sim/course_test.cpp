// Courses on a scripted body: headings, places, paths, and other bodies.
#include "sim/control/course.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::HasSubstr;
using Place = Eigen::Vector3d;

// A cube of 1 m about the origin.
struct Traveller {
  explicit Traveller(const std::string& yaml, bool planar = false)
      : mass(Vector::Ones(2)),
        rest(planar ? Vector(Eigen::Vector4d(-0.5, -0.5, 0.5, 0.5)) : Vector(6)),
        body{mass, planar ? rest : (rest << -0.5, -0.5, -0.5, 0.5, 0.5, 0.5).finished(), 1, 9.81, 0.02},
        course(body, settings(add_course(object("Anything.")), yaml)) {}
  Vector mass, rest;
  ControlledBody body;
  Course course;
};

TEST(Course, KeepsToTheLineOfItsHeading) {
  Course course = Traveller("{heading_deg: 90}").course;
  const Course::Way first = course.way({3, 1, 5}, 1, {});
  EXPECT_NEAR((first.forward - Place(1, 0, 0)).norm(), 0, 1e-15);
  EXPECT_EQ(first.offset, 0);
  EXPECT_TRUE(std::isinf(first.left));
  EXPECT_NEAR(course.way({7, 2, 4.5}, 1, {}).offset, 0.5, 1e-15) << "left of +x is -z";
  EXPECT_FALSE(course.ends(course.way({99, 0, 5}, 1, {})));
  EXPECT_EQ(Traveller("{}").course.way({0, 0, 0}, 1, {}).forward, Place(0, 0, 1));
  EXPECT_EQ(Traveller("{}", true).course.way({0, 0, 0}, 1, {}).forward, Place(1, 0, 0));
}

TEST(Course, LeadsToAPlaceAndEndsThere) {
  Course course = Traveller("{to: [3, 7, 4]}").course;
  const Course::Way way = course.way({0, 0.5, 0}, 1, {});
  EXPECT_NEAR((way.forward - Place(0.6, 0, 0.8)).norm(), 0, 1e-15);
  EXPECT_NEAR(way.left, 5, 1e-15);
  EXPECT_EQ(way.offset, 0);
  EXPECT_FALSE(course.ends(course.way({3, 0, 3.84}, 1, {})));
  EXPECT_TRUE(course.ends(course.way({3, 0, 4.14}, 1, {}))) << "0.15 of its width away";
  // Pushed aside, it heads for the place and not for the line.
  EXPECT_NEAR((course.way({3, 0, 0}, 1, {}).forward - Place(0, 0, 1)).norm(), 0, 1e-15);
  // Beyond it, back.
  EXPECT_NEAR((course.way({3, 0, 9}, 1, {}).forward - Place(0, 0, -1)).norm(), 0, 1e-15);
}

TEST(Course, FollowsAPathAroundItsCorners) {
  Course course = Traveller("{path: [[4, 0, 0], [4, 0, 3], [0, 0, 3]]}").course;
  Place at(0, 0.5, 0);
  double last = course.way(at, 0.5, {}).left;
  EXPECT_NEAR(last, 11, 1e-12);
  double farthest = 0, length = 0;
  while (!course.ends(course.way(at, 0.5, {})) && length < 20) {
    const Course::Way way = course.way(at, 0.5, {});
    EXPECT_LE(way.left, last + 0.02);
    last = way.left;
    at += 0.02 * way.forward;
    length += 0.02;
    const Place p = at;
    const double off = std::min({std::hypot(p.z(), std::max(0.0, p.x() - 4)),
                                 std::hypot(p.x() - 4, std::max({0.0, -p.z(), p.z() - 3})),
                                 std::hypot(p.z() - 3, std::max(0.0, p.x() - 4))});
    farthest = std::max(farthest, off);
  }
  EXPECT_NEAR(std::hypot(at.x(), at.z() - 3), 0, 0.15);
  EXPECT_LT(farthest, 0.35) << "it cuts corners by less than it looks ahead";
  EXPECT_GT(length, 10);
  EXPECT_LT(length, 11.2);
}

TEST(Course, FollowsAPathThatTurnsBack) {
  Course out_and_back = Traveller("{path: [[2, 0, 0], [0, 0, 0]]}", true).course;
  Course acute = Traveller("{path: [[2, 0, 0], [0, 0, 0.5]]}").course;
  for (Course* course : {&out_and_back, &acute}) {
    Place at(0, 0.5, 0);
    double farthest = 0;
    int steps = 0;
    for (Course::Way way = course->way(at, 0.7, {}); !course->ends(way) && steps < 1000; ++steps) {
      at += 0.02 * way.forward;
      farthest = std::max(farthest, at.x());
      way = course->way(at, 0.7, {});
    }
    EXPECT_NEAR(farthest, 2, 0.03);
    EXPECT_NEAR(at.x(), 0, 0.16);
    EXPECT_LT(steps, 220);
  }
  // Beside the corner it goes on along the line, and not round the corner for ever.
  Course aside = Traveller("{path: [[2, 0, 0], [0, 0, 0]]}").course;
  aside.way({0, 0, 0}, 0.7, {});
  EXPECT_GT(aside.way({1.95, 0, 0.2}, 0.7, {}).forward.x(), 0.9);
}

TEST(Course, ChasesAndFlees) {
  const std::vector<OtherBody> others = {{"mouse", {0, 0, 2}, false}, {"cat", {0, 0, -2}, false}};
  Course cat = Traveller("{chase: mouse}").course, mouse = Traveller("{flee: cat}").course;
  EXPECT_EQ(cat.way({0, 0, -2}, 1, others).forward, Place(0, 0, 1));
  EXPECT_EQ(mouse.way({1, 0, -2}, 1, others).forward, Place(1, 0, 0));
  EXPECT_EQ(mouse.way({0, 0, 0}, 1, {}).forward, Place(1, 0, 0)) << "goes on when it sees nobody";
  Course flat = Traveller("{chase: mouse}", true).course;
  EXPECT_EQ(flat.way({1, 0, 0}, 1, others).forward, Place(-1, 0, 0)) << "within the plane";
}

TEST(Course, GoesOnAfterARestart) {
  const std::string yaml = "{path: [[4, 0, 0], [4, 0, 3], [0, 0, 3]]}";
  Course a = Traveller(yaml).course, b = Traveller(yaml).course;
  a.way({0, 0, 0}, 0.5, {});
  a.way({4.1, 0, 1}, 0.5, {});
  b.restore(a.state());
  const Course::Way from_a = a.way({4, 0, 2}, 0.5, {}), from_b = b.way({4, 0, 2}, 0.5, {});
  EXPECT_EQ(from_a.forward, from_b.forward);
  EXPECT_EQ(from_a.left, from_b.left);
}

TEST(Course, RefusesTwoCoursesAndWaysOutOfThePlane) {
  const auto message = [](const std::string& yaml, bool planar) -> std::string {
    try {
      Traveller traveller(yaml, planar);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.full_text();
    }
    return {};
  };
  EXPECT_THAT(message("{to: [1, 0, 0], flee: cat}", false), HasSubstr("to and .flee are two courses"));
  EXPECT_THAT(message("{heading_deg: 30}", true), HasSubstr("out of the plane"));
  EXPECT_EQ(message("{heading_deg: -90}", true), "");
}

}  // namespace
}  // namespace vivify::sim
