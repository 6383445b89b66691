#include "scratch.h"

#include <algorithm>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace wavefog::wfog {

using std::size_t;

namespace {

/// What the first request, a tile's values, is a part of.
constexpr size_t kOfValues = 4;
constexpr size_t kLargePage = size_t(2) << 20;

size_t rounded_up(size_t size, size_t to) {
    return (size + to - 1) / to * to;
}

}  // namespace

Scratch::Block Scratch::make_block(size_t size) {
    const bool large = size >= kLargePage;
    const auto alignment = static_cast<std::align_val_t>(large ? kLargePage : kRound);
    if (large) size = rounded_up(size, kLargePage);
    Block block{{static_cast<std::byte*>(::operator new[](size, alignment)), Free{alignment}},
                size};
#ifdef __linux__
    // One fault instead of 512. Where the system has no large pages, small ones do.
    if (large) madvise(block.bytes.get(), size, MADV_HUGEPAGE);
#endif
    return block;
}

std::byte* Scratch::bytes(size_t wanted) {
    wanted = rounded_up(wanted, kRound);
    while (block_ < blocks_.size() && blocks_[block_].size - used_ < wanted) {
        ++block_;
        used_ = 0;
    }
    if (block_ == blocks_.size()) {
        blocks_.push_back(
            make_block(std::max(blocks_.empty() ? kOfValues * wanted : wanted, total_)));
        total_ += blocks_.back().size;
    }
    std::byte* const taken = blocks_[block_].bytes.get() + used_;
    used_ += wanted;
    return taken;
}

}  // namespace wavefog::wfog
