#pragma once
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sim {

/// Maximum depth of nested arrays and objects in a JSON file that Raywatt writes.
inline constexpr std::size_t kDeepestJson = 64;
/// Maximum number of keys of one JSON object: several times the number of keys in a report of the largest machine.
inline constexpr std::size_t kMostJsonKeys = 250'000;

/// Exception: a JSON value has the wrong type, a key or element is absent, or a text is not valid JSON.
class JsonError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t { kSyntax, kNumberRange, kType, kKey, kIndex };

  JsonError(Kind found, const std::string& what, std::size_t bytes = 0)
      : std::runtime_error(what), kind(found), bytes_read(bytes) {}

  Kind kind;
  std::size_t bytes_read;  ///< for kSyntax: number of bytes up to and including the invalid byte
};

/// An iterator over the elements of a JSON array or over the values of a JSON object.
template <class Value, class Entry>
class JsonIterator {
 public:
  using iterator_category = std::forward_iterator_tag;
  using value_type = std::remove_const_t<Value>;
  using difference_type = std::ptrdiff_t;
  using pointer = Value*;
  using reference = Value&;

  JsonIterator() = default;
  explicit JsonIterator(Value* element) : element_(element) {}
  explicit JsonIterator(Entry* entry) : entry_(entry) {}

  Value& operator*() const { return entry_ != nullptr ? entry_->value : *element_; }
  Value* operator->() const { return &**this; }
  JsonIterator& operator++() {
    if (entry_ != nullptr) {
      ++entry_;
    } else {
      ++element_;
    }
    return *this;
  }
  JsonIterator operator++(int) {
    JsonIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const JsonIterator&) const = default;

 private:
  Value* element_ = nullptr;
  Entry* entry_ = nullptr;
};

/// A JSON pointer: the path of a value in a JSON tree, such as "/frames/0/cycles". In a key, "~1" encodes '/' and "~0"
/// encodes '~'.
class JsonPointer {
 public:
  explicit JsonPointer(std::string_view text);
  const std::vector<std::string>& path_tokens() const { return tokens_; }

 private:
  std::vector<std::string> tokens_;
};

/// A JSON value. Objects keep the order in which their keys were added. Finding a key takes logarithmic time.
///
/// 1. A braced list is an object if each element is a list of a string and a value, and an array otherwise. If keys are
/// equal, the first one counts.
/// 2. Functions throw JsonError for a value of the wrong type, an absent key or an absent element.
/// 3. Iteration visits the elements of an array or the values of an object. Null counts as empty; any other value is
/// visited itself.
class Json {
 public:
  enum class Type : std::uint8_t { kNull, kBoolean, kInteger, kUnsigned, kDouble, kString, kArray, kObject };
  struct Entry;
  using value_type = Json;
  using iterator = JsonIterator<Json, Entry>;
  using const_iterator = JsonIterator<const Json, const Entry>;

  Json() = default;
  Json(std::nullptr_t) {}
  template <std::same_as<bool> T>
  Json(T value) : type_(Type::kBoolean) {
    value_.boolean = value;
  }
  template <std::signed_integral T>
  Json(T value) : type_(Type::kInteger) {
    value_.integer = value;
  }
  template <std::unsigned_integral T>
  requires(!std::same_as<T, bool>) Json(T value) : type_(Type::kUnsigned) { value_.natural = value; }
  template <std::floating_point T>
  Json(T value) : type_(Type::kDouble) {
    value_.real = static_cast<double>(value);
  }
  Json(const char* text);
  Json(std::string text);
  Json(std::string_view text);
  Json(std::initializer_list<Json> list);
  Json(std::vector<Json> elements);
  template <class T>
  Json(const std::vector<T>& values) : Json(array()) {
    for (const T& value : values) push_back(value);
  }
  template <class T, std::size_t N>
  Json(const std::array<T, N>& values) : Json(array()) {
    for (const T& value : values) push_back(value);
  }
  template <class T, std::size_t N>
  Json(std::span<T, N> values) : Json(array()) {
    for (const T& value : values) push_back(value);
  }
  template <class T>
  Json(const std::set<T>& values) : Json(array()) {
    for (const T& value : values) push_back(value);
  }
  template <class T>
  Json(const std::map<std::string, T>& values) : Json(object()) {
    for (const auto& [key, value] : values) (*this)[key] = value;
  }
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(Json other) noexcept;
  ~Json();

  static Json array() { return Json(Type::kArray); }
  static Json array(std::initializer_list<Json> elements);
  static Json object() { return Json(Type::kObject); }

  bool is_null() const { return type_ == Type::kNull; }
  bool is_boolean() const { return type_ == Type::kBoolean; }
  bool is_number() const { return is_number_integer() || type_ == Type::kDouble; }
  bool is_number_integer() const { return type_ == Type::kInteger || type_ == Type::kUnsigned; }
  bool is_number_unsigned() const { return type_ == Type::kUnsigned; }
  bool is_number_float() const { return type_ == Type::kDouble; }
  bool is_string() const { return type_ == Type::kString; }
  bool is_array() const { return type_ == Type::kArray; }
  bool is_object() const { return type_ == Type::kObject; }
  bool is_structured() const { return is_array() || is_object(); }

  /// Returns the JSON value converted to T: bool, a number type, std::string, or a std::vector of std::string, double
  /// or std::uint64_t. Numbers are cast to T. Throws JsonError for a value of another kind.
  template <class T>
  T get() const;
  /// Returns a reference to the text of a JSON string. The reference is valid until the value changes. T must be const
  /// std::string&.
  template <class T>
  T get_ref() const;

  std::size_t size() const;  ///< number of elements or keys of a JSON value; 0 for null, 1 for a boolean, number or
                             ///< string
  bool empty() const { return size() == 0; }
  iterator begin();
  iterator end();
  const_iterator begin() const;
  const_iterator end() const;
  Json& front();
  const Json& front() const;
  Json& back();
  const Json& back() const;

  /// Returns the entries of a JSON object in the order in which their keys were added; empty for null. The caller must
  /// not change the keys.
  std::span<Entry> items();
  std::span<const Entry> items() const;
  bool contains(std::string_view key) const;
  bool contains(const JsonPointer& pointer) const;
  iterator find(std::string_view key);
  const_iterator find(std::string_view key) const;

  Json& at(std::string_view key);
  const Json& at(std::string_view key) const;
  Json& at(std::size_t index);
  const Json& at(std::size_t index) const;
  const Json& at(const JsonPointer& pointer) const;
  /// Returns the value of a key of a JSON object. If the key is absent, it is added with a null value. Called on null,
  /// it creates an object.
  Json& operator[](std::string_view key);
  Json& operator[](std::size_t index) { return at(index); }
  /// Returns the value at a path of the JSON tree. Adds absent values along the path: arrays for numeric tokens,
  /// objects for others.
  Json& operator[](const JsonPointer& pointer);
  const Json& operator[](std::string_view key) const { return at(key); }
  const Json& operator[](std::size_t index) const { return at(index); }
  const Json& operator[](const JsonPointer& pointer) const { return at(pointer); }

  /// Returns the value of a key of a JSON object, converted as by get(); `otherwise` if the key is absent.
  template <class T>
  T value(std::string_view key, T otherwise) const {
    const Json* found = find_for_value(key);
    return found != nullptr ? found->get<T>() : otherwise;
  }
  std::string value(std::string_view key, const char* otherwise) const { return value(key, std::string(otherwise)); }

  /// Appends an element to a JSON array. Null becomes an array first.
  void push_back(Json element);
  /// Copies all keys and values of another JSON object into this JSON object. Null becomes an object first.
  void update(const Json& other);
  /// Removes a key from a JSON object, if it exists. The time is linear in the number of keys.
  void erase(std::string_view key);
  /// Sorts the keys of all objects in the JSON tree by their bytes.
  void sort_keys();
  /// Returns a JSON object with all leaves of the tree. The key of a leaf is its JSON pointer. Empty arrays and objects
  /// become null.
  Json flatten() const;

  /// True if two JSON values are equal. Numbers of different types are compared by value. Objects with different orders
  /// of keys are not equal.
  friend bool operator==(const Json& a, const Json& b) { return a.equals_json(b); }

 private:
  friend class JsonBuilder;
  struct Object;
  union Value {
    bool boolean;
    std::int64_t integer;
    std::uint64_t natural = 0;
    double real;
    std::string* text;
    std::vector<Json>* elements;
    Object* object;
  };

  explicit Json(Type type);
  [[noreturn]] void refuse(int number, const char* what) const;
  Json move_out() const noexcept;  ///< moves an element out of a braced list
  bool equals_json(const Json& other) const;
  const Json* find_value(std::string_view key) const;
  const Json* find_for_value(std::string_view key) const;
  const Json* find_at(const JsonPointer& pointer) const;
  Json& add(std::string key);
  template <class T>
  T to_number() const;
  template <class T>
  std::vector<T> to_list() const;

  // Mutable, because move_out() moves elements of an initializer list, which are const. No other function changes a
  // const value.
  mutable Type type_ = Type::kNull;
  mutable Value value_;
};

struct Json::Entry {
  std::string key;
  Json value;
};

template <>
bool Json::get() const;
template <>
int Json::get() const;
template <>
std::uint32_t Json::get() const;
template <>
std::int64_t Json::get() const;
template <>
std::uint64_t Json::get() const;
template <>
float Json::get() const;
template <>
double Json::get() const;
template <>
std::string Json::get() const;
template <>
Json Json::get() const;
template <>
std::vector<std::string> Json::get() const;
template <>
std::vector<double> Json::get() const;
template <>
std::vector<std::uint64_t> Json::get() const;
template <>
const std::string& Json::get_ref() const;

/// Writes a JSON value as one line, for test messages.
std::ostream& operator<<(std::ostream& out, const Json& json);

/// True if a JSON text nests objects and arrays deeper than `levels`. Used to limit the stack of recursive functions.
/// The result for invalid JSON is arbitrary.
bool is_nested_deeper(std::string_view json, std::size_t levels);

/// Throws InputError if a JSON text nests objects and arrays deeper than `levels`.
void check_json_depth(std::string_view json, std::size_t levels = kDeepestJson);

/// Returns a JSON value as text in one line. Bytes that are not UTF-8 become U+FFFD (with_escaped_bytes() of
/// printable.h keeps them). Numbers have the fewest digits from which they can be parsed exactly.
std::string json_line(const Json& json);
/// Returns a JSON value as text, indented over several lines. Otherwise equal to json_line().
std::string json_lines(const Json& json);

/// Parses untrusted JSON text in linear time. If keys of an object are equal, the last value counts, at the position of
/// the first. Throws InputError for more than `levels` levels or kMostJsonKeys keys per object; JsonError for invalid
/// JSON.
Json parse_json(std::string_view text, std::size_t levels = kDeepestJson);
/// Parses the next JSON value of a stream. Throws like the other parse_json(). The caller must have checked the nesting
/// depth.
Json parse_json(std::istream& text);

/// Throws the InputError of whole_number(). `what`: description of the value; `min`, `max`: allowed range.
[[noreturn]] void throw_not_whole_number(std::string_view what, std::string_view min, std::string_view max);

/// Converts untrusted JSON to a whole number of type T. If the value is not such a number, throws InputError with a
/// text that begins with `what`. (get() would cast any number.)
template <class T>
T whole_number(const Json& json, std::string_view what) {
  if (json.is_number_unsigned()) {
    const auto number = json.get<std::uint64_t>();
    if (std::in_range<T>(number)) return static_cast<T>(number);
  } else if (json.is_number_integer()) {
    const auto number = json.get<std::int64_t>();
    if (std::in_range<T>(number)) return static_cast<T>(number);
  }
  throw_not_whole_number(what, std::to_string(std::numeric_limits<T>::min()),
                         std::to_string(std::numeric_limits<T>::max()));
}

}  // namespace sim
