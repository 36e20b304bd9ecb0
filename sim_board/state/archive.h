#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace koboshi::sim_board {

// Thrown if a simulation cannot be saved because a part of it is outside this process. `what()` is one line.
class NotSaveable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// State saved by a StateArchive. Only the objects from which it was saved can restore it.
class SavedState {
 public:
  SavedState() = default;
  SavedState(SavedState&&) = default;
  SavedState& operator=(SavedState&&) = default;

  // Size of the state saved as bytes, without copies of containers.
  std::size_t size_bytes() const { return bytes_.size(); }

 private:
  friend class StateArchive;

  std::vector<std::byte> bytes_;
  std::vector<std::shared_ptr<const void>> copies_;
};

class StateArchive;

namespace archive_detail {

template <typename T>
concept HasArchive = requires(T& member, StateArchive& archive) {
  member.archive(archive);
};

// A type whose bytes are its complete value. (Eigen's vectors are not trivially copyable only because their
// copy functions are user-defined.)
template <typename T>
concept OwnsNothing = std::is_trivially_destructible_v<T> && std::is_copy_assignable_v<T>;

template <typename T>
inline constexpr bool kIsRange = false;
template <typename T>
inline constexpr bool kIsRange<std::vector<T>> = true;
template <typename T, std::size_t kSize>
inline constexpr bool kIsRange<std::array<T, kSize>> = true;

template <typename T>
inline constexpr bool kIsHolder = false;
template <typename T>
inline constexpr bool kIsHolder<std::optional<T>> = true;
template <typename T>
inline constexpr bool kIsHolder<std::unique_ptr<T>> = true;

// Whether a value is saved by the `archive` functions of its elements instead of by a copy.
template <typename T>
inline constexpr bool kIsAsked = HasArchive<T>;
template <typename T>
inline constexpr bool kIsAsked<std::vector<T>> = kIsAsked<T>;
template <typename T, std::size_t kSize>
inline constexpr bool kIsAsked<std::array<T, kSize>> = kIsAsked<T>;
template <typename T>
inline constexpr bool kIsAsked<std::optional<T>> = kIsAsked<T>;
template <typename T>
inline constexpr bool kIsAsked<std::unique_ptr<T>> = true;

}  // namespace archive_detail

// Saves the state of objects to a SavedState, or restores it to the same objects. A class lists its state
// once for both directions:
//
//   void archive(StateArchive& archive) { archive(position_, speed_, queue_); }
//
// Constants, references and configuration are not state: the constructor sets them. Supported members are
//   - objects with an `archive` function;
//   - values that own nothing: their bytes are saved;
//   - other copyable values, such as strings and containers: a copy is kept;
//   - containers, optionals and owning pointers of objects with an `archive` function. Their count is fixed.
// Copyable members are saved as a whole. Only non-copyable classes need an `archive` function, so only they
// can omit a member by mistake.
class StateArchive {
 public:
  template <typename... Objects>
  static SavedState save(Objects&... objects) {
    SavedState state;
    StateArchive archive(&state, nullptr);
    archive(objects...);
    return state;
  }
  // Restores objects to the state saved from them. Throws std::logic_error if the number of their parts has
  // changed; their state is then undefined.
  template <typename... Objects>
  static void restore(const SavedState& state, Objects&... objects) {
    StateArchive archive(nullptr, &state);
    archive(objects...);
    archive.end();
  }

  bool writes() const { return to_ != nullptr; }

  template <typename... Members>
  void operator()(Members&... members) {
    (visit(members), ...);
  }

  // Saves objects that own no memory but contain pointers to themselves and each other: the firmware and
  // CANopen nodes. Such objects cannot be copied elsewhere. They and all that they point to keep their
  // addresses, however, so their bytes are their complete state: pointers, references and virtual table
  // pointers stay valid.
  template <typename... Objects>
  void in_place(Objects&... objects) {
    static_assert((std::is_trivially_destructible_v<Objects> && ...), "an object that may own memory");
    (bytes(std::as_writable_bytes(std::span(&objects, 1))), ...);
  }

  // Saves memory of a fixed size.
  void bytes(std::span<std::byte> bytes);
  // Saves flash of a fixed size, without trailing erased bytes (0xFF).
  void flash(std::span<std::byte> bytes);

 private:
  StateArchive(SavedState* to, const SavedState* from) : to_(to), from_(from) {}

  template <typename T>
  void visit(T& member) {
    using namespace archive_detail;
    if constexpr (HasArchive<T>) {
      member.archive(*this);
    } else if constexpr (kIsAsked<T> && kIsRange<T>) {
      same(member.size());
      for (auto& element : member) visit(element);
    } else if constexpr (kIsAsked<T> && kIsHolder<T>) {
      same(member ? 1 : 0);
      if (member) visit(*member);
    } else if constexpr (OwnsNothing<T>) {
      bytes(std::as_writable_bytes(std::span(&member, 1)));
    } else {
      static_assert(std::is_copy_constructible_v<T> && std::is_copy_assignable_v<T>,
                    "a member that is neither copyable nor of a class with an `archive` function");
      copy(member);
    }
  }

  template <typename T>
  void copy(T& member) {
    if (writes()) {
      to_->copies_.push_back(std::make_shared<const T>(member));
    } else {
      member = *static_cast<const T*>(next_copy());
    }
  }

  // Throws if the count differs from the saved one.
  void same(std::size_t count);
  // Throws if saved data are left.
  void end() const;
  std::span<const std::byte> next_bytes(std::size_t count);
  const void* next_copy();

  SavedState* to_;
  const SavedState* from_;
  std::size_t next_byte_ = 0;
  std::size_t next_copy_ = 0;
};

}  // namespace koboshi::sim_board
