// Method radial: the tables of all fogs and eyes of one fog pass.
#pragma once

#include <vector>

#include "radial_table.h"

namespace wavefog {

struct RadialFog {
    const FogFacts* facts;  ///< the caller's
    GLuint cells;
};

/// A table a fog for each eye; views from one eye share them.
class RadialTables {
  public:
    static Result<RadialTables> create(const Gl& gl, std::vector<RadialFog> fogs,
                                       const Method& method);

    /// FogPass::set_views().
    Result<void> set_views(const std::vector<FogView>& views);

    /// One table a fog for the view's rays, filled where they are not there already.
    const std::vector<RadialTable>& update(const FogView& view, double seconds);
    void forget();

    bool layered(std::size_t fog) const;
    std::size_t bytes() const;
    std::size_t fills() const { return fills_; }

  private:
    struct Eye {
        Eigen::Vector3d at{0, 0, 0};
        std::vector<RadialView> views;  ///< that share the tables; none: of the last camera drawn
        RadialView all;                 ///< what they need together
        double limit = 0;               ///< longest sky ray, m
        std::vector<RadialTable> tables;
    };

    RadialTables(const Gl& gl, std::vector<RadialFog> fogs, const Method& method)
        : gl_(&gl), fogs_(std::move(fogs)), method_(method) {}
    Result<void> make_tables(Eye& eye) const;

    const Gl* gl_;
    std::vector<RadialFog> fogs_;
    Method method_;
    std::vector<RadialFill> fillers_;  ///< one a fog
    std::vector<Eye> eyes_;            ///< at least one
    std::size_t fills_ = 0;
};

}  // namespace wavefog
