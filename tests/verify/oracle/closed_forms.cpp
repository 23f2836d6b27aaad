#include "tests/verify/oracle/closed_forms.h"

#include <algorithm>
#include <utility>

namespace facetless::oracle {
namespace {

using Polynomial = std::vector<Real>;

Polynomial Product(const Polynomial& a, const Polynomial& b) {
  Polynomial result(a.size() + b.size() - 1, 0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
  return result;
}

// Returns a + s·b.
Polynomial Sum(Polynomial a, Real s, const Polynomial& b) {
  a.resize(std::max(a.size(), b.size()), 0);
  for (std::size_t i = 0; i < b.size(); ++i) a[i] += s * b[i];
  return a;
}

Real Value(const Polynomial& polynomial, Real t) {
  Real value = 0;
  for (std::size_t i = polynomial.size(); i-- > 0;) value = value * t + polynomial[i];
  return value;
}

// The points of the line relative to `center`, parametrised from the nearest one on: |p|² and p·axis as
// polynomials.
struct Near {
  Real shift = 0;  // shift of t
  Polynomial square, along;
};
Near NearTo(const Line& line, Real3 center, Real3 axis) {
  const Real3 from = line.origin - center;
  const Real speed = Dot(line.direction, line.direction);
  const Real shift = -Dot(from, line.direction) / speed;
  const Real3 nearest = from + shift * line.direction;
  return {shift,
          {Dot(nearest, nearest), 2 * Dot(nearest, line.direction), speed},
          {Dot(nearest, axis), Dot(line.direction, axis)}};
}

std::vector<Real> Shifted(std::vector<Real> roots, Real shift) {
  for (Real& root : roots) root += shift;
  return roots;
}

}  // namespace

std::vector<Real> PolynomialRoots(std::vector<Real> coefficients) {
  while (!coefficients.empty() && coefficients.back() == 0) coefficients.pop_back();
  if (coefficients.size() < 2) return {};
  if (coefficients.size() == 2) return {-coefficients[0] / coefficients[1]};
  // Between two zeros of the derivative there is at most one root, and there is none beyond Cauchy's bound.
  Polynomial derivative;
  Real bound = 0;
  for (std::size_t i = 0; i + 1 < coefficients.size(); ++i) {
    derivative.push_back(Real(static_cast<double>(i + 1)) * coefficients[i + 1]);
    bound = Max(bound, Abs(coefficients[i] / coefficients.back()));
  }
  std::vector<Real> stations = PolynomialRoots(derivative);
  stations.insert(stations.begin(), -(1 + bound));
  stations.push_back(1 + bound);
  std::vector<Real> roots;
  for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
    Real low = stations[i], high = stations[i + 1];
    if (Value(coefficients, low) == 0) roots.push_back(low);
    const bool rises = Value(coefficients, low) < 0;
    if (rises ? !(Value(coefficients, high) > 0)
              : !(Value(coefficients, low) > 0 && Value(coefficients, high) < 0))
      continue;
    // Bisect until the two ends are neighbouring numbers.
    for (Real middle = (low + high) / 2; middle > low && middle < high; middle = (low + high) / 2)
      ((Value(coefficients, middle) < 0) == rises ? low : high) = middle;
    roots.push_back(low);
  }
  return roots;
}

std::vector<Real> LinePlane(const Line& line, Real3 point, Real3 normal) {
  return PolynomialRoots({Dot(line.origin - point, normal), Dot(line.direction, normal)});
}

std::vector<Real> LineSphere(const Line& line, Real3 center, Real radius) {
  const Near near = NearTo(line, center, {0, 0, 1});
  return Shifted(PolynomialRoots(Sum(near.square, -radius * radius, {1})), near.shift);
}

std::vector<Real> LineCylinder(const Line& line, Real3 center, Real3 axis, Real radius) {
  const Near near = NearTo(line, center, axis);
  const Polynomial across = Sum(near.square, -1, Product(near.along, near.along));
  return Shifted(PolynomialRoots(Sum(across, -radius * radius, {1})), near.shift);
}

std::vector<Real> LineCone(const Line& line, Real3 apex, Real3 axis, Real slope) {
  const Near near = NearTo(line, apex, axis);
  return Shifted(PolynomialRoots(Sum(near.square, -1 - slope * slope, Product(near.along, near.along))),
                 near.shift);
}

std::vector<Real> LineTorus(const Line& line, Real3 center, Real3 axis, Real major, Real minor) {
  // (|p|² + R² − r²)² = 4R²·(|p|² − (p·a)²).
  const Near near = NearTo(line, center, axis);
  const Polynomial left = Sum(near.square, major * major - minor * minor, {1});
  const Polynomial across = Sum(near.square, -1, Product(near.along, near.along));
  return Shifted(PolynomialRoots(Sum(Product(left, left), -4 * major * major, across)), near.shift);
}

}  // namespace facetless::oracle
