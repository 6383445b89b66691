// Memory for the work on one tile, used again for the next: fresh pages cost as much as what is
// computed on them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace wavefog::wfog {

class Scratch {
  public:
    /// Values that are not set, until clear().
    template <class T>
    std::span<T> take(std::size_t count) {
        static_assert(std::is_trivial_v<T> && alignof(T) <= kAlignment);
        return {reinterpret_cast<T*>(bytes(count * sizeof(T))), count};
    }
    void clear() { block_ = used_ = 0; }

  private:
    static constexpr std::size_t kAlignment = 16, kRound = 64, kFirstBlock = 1 << 16;

    struct Block {
        std::unique_ptr<std::byte[]> bytes;
        std::size_t size = 0;
    };

    std::byte* bytes(std::size_t wanted) {
        wanted = (wanted + kRound - 1) / kRound * kRound;
        while (block_ < blocks_.size() && blocks_[block_].size - used_ < wanted) {
            ++block_;
            used_ = 0;
        }
        if (block_ == blocks_.size()) {
            const std::size_t size = std::max({wanted, total_, kFirstBlock});
            blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size});
            total_ += size;
        }
        std::byte* const taken = blocks_[block_].bytes.get() + used_;
        used_ += wanted;
        return taken;
    }

    std::vector<Block> blocks_;
    std::size_t block_ = 0, used_ = 0, total_ = 0;
};

}  // namespace wavefog::wfog
