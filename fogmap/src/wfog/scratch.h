// Memory for the work on one tile, used again for the next: fresh pages cost as much as what is
// computed on them.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

namespace wavefog::wfog {

class Scratch {
  public:
    /// Values that are not set, until clear() or release().
    template <class T>
    std::span<T> take(std::size_t count) {
        static_assert(std::is_trivial_v<T> && alignof(T) <= kRound);
        return {reinterpret_cast<T*>(bytes(count * sizeof(T))), count};
    }
    void clear() { release({}); }

    struct Mark {
        std::size_t block = 0, used = 0;
    };
    Mark mark() const { return {block_, used_}; }
    /// Gives back what was taken since.
    void release(const Mark& mark) {
        block_ = mark.block;
        used_ = mark.used;
    }

  private:
    static constexpr std::size_t kRound = 64;

    struct Free {
        std::align_val_t alignment;
        void operator()(std::byte* bytes) const { ::operator delete[](bytes, alignment); }
    };
    struct Block {
        std::unique_ptr<std::byte[], Free> bytes;
        std::size_t size;
    };

    static Block make_block(std::size_t size);
    std::byte* bytes(std::size_t wanted);

    std::vector<Block> blocks_;
    std::size_t block_ = 0, used_ = 0, total_ = 0;
};

}  // namespace wavefog::wfog
