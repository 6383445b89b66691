// A linear predictor that learns from what has been coded: recursive weighted least squares with
// forgetting, solved by Cholesky (X. Wu, K. U. Barthel, W. Zhang, "Piecewise 2D autoregression for
// predictive image coding", 1998).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace wavefog::wfog {

template <std::size_t N>
class LeastSquares {
  public:
    using Inputs = std::array<double, N>;

    double predict(const Inputs& x) const {
        double sum[4] = {0, 0, 0, 0};
        for (std::size_t i = 0; i < N; i += 4)
            for (std::size_t k = 0; k < 4; ++k) sum[k] += weights_[i + k] * x[i + k];
        return (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }

    /// `confidence` weighs this sample against others.
    void learn(const Inputs& x, double truth, double confidence) {
        const double scale = confidence * growth_;
        for (std::size_t i = 0; i < N; ++i) {
            const double xi = x[i] * scale;
            std::array<double, N>& row = moments_[i];
            for (std::size_t j = 0; j <= i; ++j) row[j] += xi * x[j];
            target_[i] += xi * truth;
        }
        growth_ *= kGrowth;
        if (++samples_ == kSolveEvery) {
            samples_ = 0;
            solve();
            if (growth_ > 1e9) shrink();
        }
    }

  private:
    static_assert(N % 4 == 0);
    static constexpr double kGrowth = 1.0005;  ///< instead of fading the old, the new counts more
    static constexpr int kSolveEvery = 32;

    void shrink() {
        const double factor = 1 / growth_;
        for (std::size_t i = 0; i < N; ++i) {
            for (std::size_t j = 0; j <= i; ++j) moments_[i][j] *= factor;
            target_[i] *= factor;
        }
        growth_ = 1;
    }

    void solve() {
        std::array<std::array<double, N>, N> l;
        std::array<double, N> inverse, y;
        for (std::size_t i = 0; i < N; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                double sum = moments_[i][j];
                for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
                l[i][j] = sum * inverse[j];
            }
            double sum = moments_[i][i] + growth_;  // ridge: weights stay small until data speak
            for (std::size_t k = 0; k < i; ++k) sum -= l[i][k] * l[i][k];
            if (!(sum > 1e-12 * growth_)) return;  // not positive definite: keep the old weights
            l[i][i] = std::sqrt(sum);
            inverse[i] = 1 / l[i][i];
            double right = target_[i];
            for (std::size_t k = 0; k < i; ++k) right -= l[i][k] * y[k];
            y[i] = right * inverse[i];
        }
        for (std::size_t i = N; i-- > 0;) {
            double right = y[i];
            for (std::size_t k = i + 1; k < N; ++k) right -= l[k][i] * weights_[k];
            weights_[i] = right * inverse[i];
        }
    }

    std::array<std::array<double, N>, N> moments_{};
    std::array<double, N> target_{}, weights_{};
    double growth_ = 1;
    int samples_ = 0;
};

}  // namespace wavefog::wfog
