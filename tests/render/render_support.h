// What the tests of the renderer share: settings from YAML text, simple meshes, goodness of fit.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "common/config.h"
#include "common/schema.h"
#include "render/render.h"
#include "render/vec.h"

namespace vivify::render::testing_support {

// `text` (YAML) resolved with `schema`; errors of the text fail the test.
Value settings(const Schema& schema, const std::string& text);

// A flat square of half side `half` around `center`, facing `normal` (+y: level), with texture coordinates in
// [0, 1]².
Mesh square(const Eigen::Vector3d& center, double half, const Eigen::Vector3d& normal,
            const std::string& material, int object_id = 1);

// A ball made of rings; `inward` turns its outer side to its centre. Flat triangles.
Mesh ball(const Eigen::Vector3d& center, double radius, const std::string& material, int rings = 32,
          bool inward = false, int object_id = 1);

// A closed box.
Mesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const std::string& material,
         int object_id = 1);

// A picture's mean radiance (three channels), and its mean over the replicates of different seeds with
// standard error.
Vec3 mean_radiance(const Film& film);
struct Estimate {
  double mean;
  double standard_error;
};
Estimate replicated(const std::function<double(std::uint64_t seed)>& value, int replicates = 16);

// Probability of a chi-square of at least `statistic` for `degrees` of freedom.
double chi_square_p(double statistic, double degrees);

// p-value of counts against expected counts; cells that expect less than 5 are pooled.
double goodness_of_fit(const std::vector<double>& counts, const std::vector<double>& expected);

// p below which one of `tests` tests is taken as failed, for a level of 1 % over all of them (Šidák).
double sidak(int tests);

// Tests directions drawn by `sample` (false: none) against their density `pdf` (per solid angle), on cells
// around `axis` within cos θ >= least_cosine; what falls elsewhere or is not drawn is one more cell. Returns
// the p-value; `integral` gets the integral of the density over the cells.
double direction_fit(const std::function<bool(const Vec2& u, float v, Vec3& direction)>& sample,
                     const std::function<double(const Vec3& direction)>& pdf, const Vec3& axis,
                     double least_cosine, std::uint64_t seed, double* integral = nullptr,
                     int samples = 100000);

}  // namespace vivify::render::testing_support
