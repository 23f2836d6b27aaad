#include "tests/verify/extremes/extreme.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "tests/verify/oracle/aim.h"
#include "tests/verify/oracle/judge.h"

namespace facetless::extremes {
namespace {

constexpr std::size_t kCertified = 2;  // index into kPrecisions
constexpr std::size_t kListed = 3;     // failures of one kind that are listed
constexpr std::uint64_t kSeed = 1;
// The memory limit of a picture. An explosion of leaves is a failure, which this limit ends quickly.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
// The number of samples without a certificate that are judged, of each picture in `certified`. The oracle
// needs long for each.
constexpr std::size_t kOthers = 2;

// Formats text as printf does.
template <typename... Arguments>
std::string Text(const char* format, Arguments... arguments) {
  char text[600];
  std::snprintf(text, sizeof text, format, arguments...);
  return text;
}

class Measuring {
 public:
  explicit Measuring(const Extreme& extreme) : extreme_(extreme), model_(extreme.model()) {}

  Measurement Run() {
    if (const Result<void> valid = Validate(model_); !valid.ok()) {
      for (Outcome& outcome : result_.outcomes) outcome.error = valid.error();
    } else {
      const Scene scene(model_);
      const oracle::Oracle judge_of_surfaces(model_);
      for (const Camera& camera : extreme_.cameras(model_)) Render(scene, judge_of_surfaces, camera);
    }
    for (std::size_t p = 0; p < kPrecisions.size(); ++p) Check(p);
    return result_;
  }

 private:
  void Fail(const std::string& kind, const std::string& what) {
    if (std::count(kinds_.begin(), kinds_.end(), kind) >= static_cast<std::ptrdiff_t>(kListed)) return;
    kinds_.push_back(kind);
    result_.failures.push_back(kind + ": " + what);
  }

  void Render(const Scene& scene, const oracle::Oracle& surfaces, const Camera& camera) {
    std::array<std::optional<DirectResult>, 3> pictures;
    for (std::size_t p = 0; p < kPrecisions.size(); ++p) {
      DirectOptions options;
      options.accuracy.precision = kPrecisions[p];
      options.depth_error = true;
      options.accuracy.max_bytes = kMostBytes;
      const auto begin = std::chrono::steady_clock::now();
      Result<DirectResult> direct = TraceDirect(scene, camera, options);
      Outcome& outcome = result_.outcomes[p];
      outcome.milliseconds +=
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
      if (!direct.ok()) {
        outcome.error = direct.error();
        continue;
      }
      pictures[p] = std::move(direct).value();
      AddUp(pictures[p]->stats, &outcome);
      CheckNumbers(p, camera, pictures[p]->samples);
      LetJudge(p, surfaces, camera, *pictures[p]);
    }
    for (std::size_t p = 0; p < kPrecisions.size(); ++p) {
      for (std::size_t q = 0; q < p; ++q) {
        if (pictures[p] && pictures[q]) Compare(q, p, camera, pictures[q]->samples, pictures[p]->samples);
      }
    }
  }

  static void AddUp(const DirectStats& stats, Outcome* outcome) {
    outcome->samples += stats.rays;
    outcome->hits += stats.hits;
    outcome->leaves += stats.leaves;
    outcome->scene_bytes = std::max(outcome->scene_bytes, stats.scene_bytes);
    outcome->certificates[0] += stats.certified;
    outcome->certificates[1] += stats.converged;
    outcome->certificates[2] += stats.unresolved;
    for (std::size_t bit = 0; bit < stats.doubts.size(); ++bit) outcome->doubts[bit] += stats.doubts[bit];
    outcome->bound_mm = std::fmax(outcome->bound_mm, stats.depth_error_max);
  }

  std::string Place(std::size_t precision, const Camera& camera, std::size_t sample) const {
    return Text("%s, view '%s', pixel %d,%d", kPrecisionNames[precision], camera.name.c_str(),
                static_cast<int>(sample) % camera.width_px, static_cast<int>(sample) / camera.width_px);
  }

  void CheckNumbers(std::size_t p, const Camera& camera, const SampleBuffer& samples) {
    // The tolerance is the rounding of a unit vector to float.
    constexpr double kUnit = 1e-6;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const bool hit = samples.face[i] != kNoIndex;
      const auto& n = samples.normal[i];
      const double length = std::sqrt(double(n[0]) * n[0] + double(n[1]) * n[1] + double(n[2]) * n[2]);
      if (hit ? !std::isfinite(samples.depth[i]) : samples.depth[i] != INFINITY)
        Fail("not a number", Place(p, camera, i) + Text(" has the depth %g", samples.depth[i]));
      // A surface that is a point or a line at the hit has no normal.
      if (!(std::fabs(length - (hit ? 1 : 0)) <= kUnit) &&
          !(length == 0 && samples.certificate[i] != Certificate::kCertified))
        Fail("no normal", Place(p, camera, i) + Text(" has a normal of length %g", length));
      if (std::isnan(samples.depth_error[i]))
        Fail("not a number", Place(p, camera, i) + " has a depth error that is none");
    }
  }

  void LetJudge(std::size_t p, const oracle::Oracle& surfaces, const Camera& camera,
                const DirectResult& direct) {
    const SampleBuffer& samples = direct.samples;
    oracle::Random random(kSeed);
    std::vector<std::uint32_t> pixels;
    if (samples.size() <= extreme_.judged) {
      for (std::uint32_t i = 0; i < samples.size(); ++i) pixels.push_back(i);
    } else {
      pixels =
          oracle::HardPixels(direct, oracle::Features(model_, 20, random), extreme_.judged * 2 / 3, random);
      for (const std::uint32_t pixel : oracle::RandomPixels(samples, extreme_.judged / 3, random))
        pixels.push_back(pixel);
      pixels.push_back(static_cast<std::uint32_t>(std::size_t(camera.height_px / 2) *
                                                      static_cast<std::size_t>(camera.width_px) +
                                                  static_cast<std::size_t>(camera.width_px / 2)));
      std::sort(pixels.begin(), pixels.end());
      pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
    }
    const oracle::Judge judge(surfaces, camera);
    Outcome& outcome = result_.outcomes[p];
    std::size_t others = 0;
    for (const std::uint32_t i : pixels) {
      const oracle::Claim claim = oracle::Judge::MakeClaim(samples, static_cast<int>(i) % samples.width,
                                                           static_cast<int>(i) / samples.width);
      const auto certificate = static_cast<std::size_t>(claim.certificate);
      if (claim.certificate != Certificate::kCertified) {
        if (p != kCertified || others++ >= kOthers) continue;
        ++outcome.judged[certificate];
        outcome.wrong[certificate] += Right(surfaces, camera, claim) ? 0 : 1;
        continue;
      }
      const oracle::Judgement judgement = judge.Ask(claim);
      ++outcome.judged[certificate];
      outcome.off_mm = std::fmax(outcome.off_mm, std::fabs(judgement.depth_off_mm));
      outcome.undecided += judgement.verdict == oracle::Verdict::kUndecided;
      outcome.within_rounding += judgement.verdict == oracle::Verdict::kWithinRounding;
      if (judgement.verdict == oracle::Verdict::kWrong) {
        ++outcome.wrong[certificate];
        Fail("certified and wrong", Place(p, camera, i) + ": " + oracle::Describe(judgement, model_));
      }
      if (p == kCertified && judgement.verdict == oracle::Verdict::kRight && judgement.other_face)
        Fail("certified on another face than the nearest", Place(p, camera, i));
    }
  }

  // Returns whether a sample without a certificate is right nevertheless: its hit is a crossing, to within
  // its bound or, without a bound, a millionth of the model; and no certain crossing is nearer.
  bool Right(const oracle::Oracle& surfaces, const Camera& camera, const oracle::Claim& claim) const {
    constexpr double kShare = 1e-6;
    const bool perspective = camera.projection == Projection::kPerspective;
    const oracle::View view{camera.eye,    camera.target,    camera.up,       perspective,
                            camera.height, camera.fov_y_deg, camera.width_px, camera.height_px};
    const double diagonal = model_.Diagonal();
    const double bound =
        std::isfinite(claim.depth_error) && claim.depth_error > 0 ? claim.depth_error : kShare * diagonal;
    bool covered = !claim.hit;
    bool nearer = false;
    for (const oracle::Crossing& crossing :
         surfaces.Crossings(ViewPixelRay(view, claim.column + 0.5, claim.row + 0.5),
                            perspective ? 1e-9 * diagonal : -INFINITY)) {
      const double off = static_cast<double>(crossing.depth - claim.depth);
      const double allowed = bound + static_cast<double>(crossing.half_depth);
      covered = covered || (std::fabs(off) <= allowed && crossing.standing != oracle::Standing::kOutside);
      nearer = nearer || (crossing.proven && crossing.standing == oracle::Standing::kInside &&
                          (!claim.hit || off < -allowed));
    }
    return covered && !nearer;
  }

  // Two precisions that both certify a sample must agree on it.
  void Compare(std::size_t p, std::size_t q, const Camera& camera, const SampleBuffer& a,
               const SampleBuffer& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a.certificate[i] != Certificate::kCertified || b.certificate[i] != Certificate::kCertified)
        continue;
      const bool hit = a.face[i] != kNoIndex;
      const double allowed = double(a.depth_error[i]) + double(b.depth_error[i]);
      if (hit == (b.face[i] != kNoIndex) && (!hit || std::fabs(a.depth[i] - b.depth[i]) <= allowed)) continue;
      Fail("certified samples contradict each other",
           Place(p, camera, i) + Text(" has %.17g mm, %s %.17g mm, with bounds that sum to %g mm", a.depth[i],
                                      kPrecisionNames[q], b.depth[i], allowed));
    }
  }

  void Check(std::size_t p) {
    const Outcome& outcome = result_.outcomes[p];
    const std::string name = kPrecisionNames[p];
    if (extreme_.error || outcome.error) {
      if (!outcome.error) Fail("no error", name + " answers though it can't");
      if (outcome.error && (!extreme_.error || outcome.error->code != *extreme_.error))
        Fail("an error", name + ": " + outcome.error->message);
      if (outcome.error && outcome.error->message.empty()) Fail("an error", name + " without a sentence");
      return;
    }
    if (!(outcome.CertifiedShare() >= extreme_.certified[p]))
      Fail("few certified samples",
           name + Text(": %.6f of %llu, promised %g", outcome.CertifiedShare(),
                       static_cast<unsigned long long>(outcome.samples), extreme_.certified[p]));
    if (p == kCertified && !(outcome.bound_mm <= extreme_.depth_bound_mm))
      Fail("a large bound", name + Text(" states a depth to within %g mm, promised %g", outcome.bound_mm,
                                        extreme_.depth_bound_mm));
    for (std::size_t bit = 0; bit < outcome.doubts.size(); ++bit) {
      if (outcome.doubts[bit] > 0 && !(extreme_.doubts >> bit & 1))
        Fail("an unexpected doubt",
             name + Text(": %llu samples are in doubt for '%s'",
                         static_cast<unsigned long long>(outcome.doubts[bit]), kDoubtNames[bit]));
    }
  }

  const Extreme& extreme_;
  const Model model_;
  Measurement result_;
  std::vector<std::string> kinds_;
};

}  // namespace

Measurement Measure(const Extreme& extreme) {
  return Measuring(extreme).Run();
}

}  // namespace facetless::extremes
