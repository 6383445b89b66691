#include "wavefog/gpu/timer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace wavefog {

FrameTimer::FrameTimer(const Gl& gl) : gl_(&gl), query_(make_query(gl)) {}

FrameTime FrameTimer::time(const std::function<void()>& draw) {
    gl_->Finish();
    const auto start = std::chrono::steady_clock::now();
    gl_->BeginQuery(GL_TIME_ELAPSED, query_.name());
    draw();
    gl_->EndQuery(GL_TIME_ELAPSED);
    gl_->Finish();
    const auto end = std::chrono::steady_clock::now();
    GLuint64 nanoseconds = 0;
    gl_->GetQueryObjectui64v(query_.name(), GL_QUERY_RESULT, &nanoseconds);
    return {double(nanoseconds) * 1e-6,
            std::chrono::duration<double, std::milli>(end - start).count()};
}

double Samples::percentile(double percent) const {
    if (values_.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::vector<double> sorted = values_;
    std::sort(sorted.begin(), sorted.end());
    const double position = std::clamp(percent, 0.0, 100.0) / 100 * double(sorted.size() - 1);
    const auto low = std::size_t(position);
    const std::size_t high = std::min(low + 1, sorted.size() - 1);
    return std::lerp(sorted[low], sorted[high], position - double(low));
}

}  // namespace wavefog
