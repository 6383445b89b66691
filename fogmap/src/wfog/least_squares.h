// A linear predictor that learns from what has been coded: recursive weighted least squares with
// forgetting, solved by Cholesky (X. Wu, K. U. Barthel, W. Zhang, "Piecewise 2D autoregression for
// predictive image coding", 1998).
#pragma once

#include <array>
#include <cstddef>

namespace wavefog::wfog {

class LeastSquares {
  public:
    static constexpr std::size_t kInputs = 16;
    using Inputs = std::array<double, kInputs>;

    double predict(const Inputs& x) const {
        double sum[4] = {0, 0, 0, 0};
        for (std::size_t i = 0; i < kInputs; i += 4)
            for (std::size_t k = 0; k < 4; ++k) sum[k] += weights_[i + k] * x[i + k];
        return (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }

    /// `confidence` weighs this sample against others.
    void learn(const Inputs& x, double truth, double confidence) {
        pending_[samples_] = {x, truth, confidence * growth_};
        growth_ *= kGrowth;
        if (++samples_ == kSolveEvery) take_pending();
    }

  private:
    static constexpr double kGrowth = 1.0005;  ///< instead of fading the old, the new counts more
    static constexpr std::size_t kSolveEvery = 32;

    struct Sample {
        Inputs x;
        double truth, scale;
    };
    using Pending = std::array<Sample, kSolveEvery>;
    using Square = std::array<Inputs, kInputs>;  ///< only j <= i of [i][j] counts

    void take_pending();
    static void add(const Pending& samples, Square& moments, Inputs& target);
    void solve();
    void shrink();

    Square moments_{};
    Inputs target_{}, weights_{};
    Pending pending_;
    double growth_ = 1;
    std::size_t samples_ = 0;
};

}  // namespace wavefog::wfog
