// FaceSpline: a face's projected surface as one B-spline, evaluated with the basis functions of its knot vectors, by the
// recursion of C. de Boor and M. Cox (1972).
//
//     const FaceSpline spline(scene, face);
//     FaceSpline::Place at;
//     if (spline.Locate(s, t, &at)) const PatchJet<3> jet = spline.Jet(at);
//
//  1. A model stores Bézier patches. The knots of the B-spline are the native breaks of the face. The multiplicity of each
//     inner knot is the degree, so that the B-spline is exactly the same surface. The B-spline in the file may have knots
//     of lower multiplicity, and so fewer control points.
//  2. The parameters s and t run from 0 to the number of columns and of rows. A descent in native parameters would depend on
//     their units, which may be radians in one direction and millimetres in the other. Each span has the share of the range
//     that it has in native parameters. Where the native parameter of a patch is an angle (SpanMap::kHalfAngle), the
//     parameter within the span is that of the patch, scaled.
//  3. There is no surface outside the range, and none where patches are trimmed away.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/solve/patch_jet.h"
#include "render/solve/solver.h"
#include "render/solve/solver_scene.h"

namespace facetless {

class FaceSpline {
 public:
  FaceSpline(const SolverScene& scene, const SolverFace& face);

  struct Place {
    double s = 0, t = 0;
    std::uint32_t i = 0, j = 0, patch = kNoIndex;
  };
  // Returns whether there is a surface at (s,t), and stores where. `inside`, if given, tells whether (s,t) is in the range.
  bool Locate(double s, double t, Place* place, bool* inside = nullptr) const;

  // The components (X, Y, W) of the projected surface, and their derivatives with respect to s and t.
  PatchJet<3> Jet(const Place& place) const;
  // The same without derivatives, which are left 0.
  PatchJet<3> Value(const Place& place) const;

  // From parameters of the face, in which every patch has the length 1.
  double S(double face_u) const { return u_.FromFace(face_u); }
  double T(double face_v) const { return v_.FromFace(face_v); }
  // To the parameters of the patch.
  SolverRoot Root(const Place& place) const {
    return {place.patch, u_.InSpan(place.s, place.i), v_.InSpan(place.t, place.j)};
  }
  std::uint64_t bytes() const { return (u_.numbers() + v_.numbers()) * sizeof(double); }

 private:
  // The knots in one direction.
  struct Axis {
    int degree = 1;
    std::uint32_t spans = 1;
    std::vector<double> knots;
    // The reciprocals of the differences of knots that the recursion divides by, for each span: level d = 1 … degree, and
    // within it the d basis functions of the level before.
    std::vector<double> reciprocals;
    std::size_t numbers() const { return knots.size() + reciprocals.size(); }
    std::size_t shares() const { return static_cast<std::size_t>(degree * (degree + 1) / 2); }
    // The first of the 2·degree knots around a span: `degree` equal ones at its begin, and `degree` at its end.
    const double* Around(std::uint32_t span) const {
      return knots.data() + static_cast<std::size_t>(degree) * span + 1;
    }
    double Break(std::uint32_t span) const {
      return knots[static_cast<std::size_t>(degree) * span + (span > 0 ? 1 : 0)];
    }
    double FromFace(double parameter) const;
    double InSpan(double s, std::uint32_t span) const;
    bool Find(double s, std::uint32_t* span) const;
  };
  template <bool kJet>
  PatchJet<3> Evaluate(const Place& place) const;

  const SolverScene& scene_;
  const SolverFace& face_;
  Axis u_, v_;
};

}  // namespace facetless
