#include "sim/io/json.h"

#include <algorithm>
#include <charconv>
#include <istream>
#include <limits>
#include <memory>
#include <ostream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"

namespace sim {

using Type = Json::Type;

// --- Objects -----------------------------------------------------------------------------------------------------

/// The entries of a JSON object, with an index if there are many. The index is a search tree, so hostile keys cannot
/// make it slow.
struct Json::Object {
  static constexpr std::size_t kFewKeys = 16;

  struct Less {
    using is_transparent = void;
    const Object* object;
    std::string_view key(std::uint32_t number) const { return object->entries[number].key; }
    bool operator()(std::uint32_t a, std::uint32_t b) const { return key(a) < key(b); }
    bool operator()(std::uint32_t a, std::string_view b) const { return key(a) < b; }
    bool operator()(std::string_view a, std::uint32_t b) const { return a < key(b); }
  };
  using Index = std::set<std::uint32_t, Less>;

  Object() = default;
  Object(const Object& other) : entries(other.entries) { make_index(); }

  void make_index() {
    index.reset();
    if (entries.size() <= kFewKeys) return;
    index = std::make_unique<Index>(Less{this});
    for (std::size_t i = 0; i < entries.size(); ++i) index->insert(static_cast<std::uint32_t>(i));
  }
  Entry* find(std::string_view key) {
    if (index != nullptr) {
      const auto found = index->find(key);
      return found == index->end() ? nullptr : &entries[*found];
    }
    const auto found = std::ranges::find(entries, key, &Entry::key);
    return found == entries.end() ? nullptr : &*found;
  }
  /// Adds an entry to the JSON object for a key, which must be absent. Returns a reference to the value.
  Json& add(std::string key) {
    entries.push_back({std::move(key), Json()});
    if (index != nullptr) {
      index->insert(static_cast<std::uint32_t>(entries.size() - 1));
    } else if (entries.size() > kFewKeys) {
      make_index();
    }
    return entries.back().value;
  }

  std::vector<Entry> entries;
  std::unique_ptr<Index> index;
};

// --- Values ------------------------------------------------------------------------------------------------------

Json::Json(const char* text) : Json(std::string(text)) {}
Json::Json(std::string_view text) : Json(std::string(text)) {}
Json::Json(std::string text) : type_(Type::kString) { value_.text = new std::string(std::move(text)); }
Json::Json(std::vector<Json> elements) : type_(Type::kArray) {
  value_.elements = new std::vector<Json>(std::move(elements));
}
Json::Json(Type type) : type_(type) {
  if (type == Type::kArray) value_.elements = new std::vector<Json>();
  if (type == Type::kObject) value_.object = new Object();
}

Json::Json(std::initializer_list<Json> list) {
  const auto is_entry = [](const Json& element) {
    return element.is_array() && element.size() == 2 && element.value_.elements->front().is_string();
  };
  if (!std::ranges::all_of(list, is_entry)) {
    *this = array(list);
    return;
  }
  *this = object();
  for (const Json& entry : list) {
    std::vector<Json>& pair = *entry.value_.elements;
    std::string& key = *pair[0].value_.text;
    if (value_.object->find(key) == nullptr) add(std::move(key)) = std::move(pair[1]);
  }
}

Json Json::array(std::initializer_list<Json> elements) {
  Json json(Type::kArray);
  json.value_.elements->reserve(elements.size());
  for (const Json& element : elements) json.value_.elements->push_back(element.move_out());
  return json;
}

Json::Json(const Json& other) : value_(other.value_) {
  if (other.type_ == Type::kString) value_.text = new std::string(*other.value_.text);
  if (other.type_ == Type::kArray) value_.elements = new std::vector<Json>(*other.value_.elements);
  if (other.type_ == Type::kObject) value_.object = new Object(*other.value_.object);
  type_ = other.type_;
}

Json::Json(Json&& other) noexcept : type_(std::exchange(other.type_, Type::kNull)), value_(other.value_) {}

Json& Json::operator=(Json other) noexcept {
  std::swap(type_, other.type_);
  std::swap(value_, other.value_);
  return *this;
}

Json::~Json() {
  if (type_ == Type::kString) delete value_.text;
  if (type_ == Type::kArray) delete value_.elements;
  if (type_ == Type::kObject) delete value_.object;
}

Json Json::move_out() const noexcept {
  Json json;
  std::swap(json.type_, type_);
  std::swap(json.value_, value_);
  return json;
}

namespace {

const char* name_of(const Json& json) {
  if (json.is_null()) return "null";
  if (json.is_boolean()) return "boolean";
  if (json.is_string()) return "string";
  if (json.is_array()) return "array";
  return json.is_object() ? "object" : "number";
}

// Error texts and numbers equal those of the nlohmann JSON library.
JsonError key_error(std::string_view key) {
  return {JsonError::Kind::kKey, fmt::format("[json.exception.out_of_range.403] key '{}' not found", key)};
}
JsonError index_error(std::size_t index) {
  return {JsonError::Kind::kIndex,
          fmt::format("[json.exception.out_of_range.401] array index {} is out of range", index)};
}

constexpr int kNotOfType = 302, kNoAt = 304, kNoIndexing = 305, kNoValue = 306, kNoErase = 307, kNoPushBack = 308,
              kNoUpdate = 312;

}  // namespace

void Json::refuse(int number, const char* what) const {
  throw JsonError(JsonError::Kind::kType,
                  fmt::format("[json.exception.type_error.{}] {} {}", number, what, name_of(*this)));
}

template <class T>
T Json::to_number() const {
  if (type_ == Type::kInteger) return static_cast<T>(value_.integer);
  if (type_ == Type::kUnsigned) return static_cast<T>(value_.natural);
  if (type_ != Type::kDouble) refuse(kNotOfType, "type must be number, but is");
  if constexpr (std::integral<T>) {
    // Numbers outside the range of T are handled separately, because their conversion is undefined.
    constexpr double kEnd = static_cast<double>(std::numeric_limits<T>::max());
    if (!(value_.real >= static_cast<double>(std::numeric_limits<T>::min()))) return std::numeric_limits<T>::min();
    if (value_.real >= kEnd) return std::numeric_limits<T>::max();
  }
  return static_cast<T>(value_.real);
}

template <class T>
std::vector<T> Json::to_list() const {
  if (type_ != Type::kArray) refuse(kNotOfType, "type must be array, but is");
  std::vector<T> all;
  all.reserve(size());
  for (const Json& element : *value_.elements) all.push_back(element.get<T>());
  return all;
}

template <>
bool Json::get<bool>() const {
  if (type_ != Type::kBoolean) refuse(kNotOfType, "type must be boolean, but is");
  return value_.boolean;
}
template <>
const std::string& Json::get_ref<const std::string&>() const {
  if (type_ != Type::kString) refuse(kNotOfType, "type must be string, but is");
  return *value_.text;
}
template <>
std::string Json::get<std::string>() const {
  return get_ref<const std::string&>();
}
template <>
int Json::get<int>() const {
  return to_number<int>();
}
template <>
std::uint32_t Json::get<std::uint32_t>() const {
  return to_number<std::uint32_t>();
}
template <>
std::int64_t Json::get<std::int64_t>() const {
  return to_number<std::int64_t>();
}
template <>
std::uint64_t Json::get<std::uint64_t>() const {
  return to_number<std::uint64_t>();
}
template <>
float Json::get<float>() const {
  return to_number<float>();
}
template <>
double Json::get<double>() const {
  return to_number<double>();
}
template <>
Json Json::get<Json>() const {
  return *this;
}
template <>
std::vector<std::string> Json::get<std::vector<std::string>>() const {
  return to_list<std::string>();
}
template <>
std::vector<double> Json::get<std::vector<double>>() const {
  return to_list<double>();
}
template <>
std::vector<std::uint64_t> Json::get<std::vector<std::uint64_t>>() const {
  return to_list<std::uint64_t>();
}

std::size_t Json::size() const {
  if (type_ == Type::kArray) return value_.elements->size();
  if (type_ == Type::kObject) return value_.object->entries.size();
  return is_null() ? 0 : 1;
}

Json::iterator Json::begin() {
  if (type_ == Type::kObject) return iterator(value_.object->entries.data());
  return iterator(type_ == Type::kArray ? value_.elements->data() : this);
}
Json::iterator Json::end() {
  if (type_ == Type::kObject) return iterator(value_.object->entries.data() + size());
  return iterator((type_ == Type::kArray ? value_.elements->data() : this) + size());
}
Json::const_iterator Json::begin() const {
  if (type_ == Type::kObject) return const_iterator(value_.object->entries.data());
  return const_iterator(type_ == Type::kArray ? value_.elements->data() : this);
}
Json::const_iterator Json::end() const {
  if (type_ == Type::kObject) return const_iterator(value_.object->entries.data() + size());
  return const_iterator((type_ == Type::kArray ? value_.elements->data() : this) + size());
}

const Json& Json::front() const { return type_ == Type::kObject && !empty() ? items().front().value : at(0); }
const Json& Json::back() const { return type_ == Type::kObject && !empty() ? items().back().value : at(size() - 1); }
Json& Json::front() { return const_cast<Json&>(std::as_const(*this).front()); }
Json& Json::back() { return const_cast<Json&>(std::as_const(*this).back()); }

std::span<Json::Entry> Json::items() {
  if (is_null()) return {};
  if (type_ != Type::kObject) refuse(kNotOfType, "type must be object, but is");
  return value_.object->entries;
}
std::span<const Json::Entry> Json::items() const { return const_cast<Json&>(*this).items(); }

const Json* Json::find_value(std::string_view key) const {
  const Entry* entry = type_ == Type::kObject ? value_.object->find(key) : nullptr;
  return entry == nullptr ? nullptr : &entry->value;
}
const Json* Json::find_for_value(std::string_view key) const {
  if (type_ != Type::kObject) refuse(kNoValue, "cannot use value() with");
  return find_value(key);
}

const Json* Json::find_at(const JsonPointer& pointer) const {
  const Json* at = this;
  for (const std::string& token : pointer.path_tokens()) {
    if (at->is_array()) {
      std::size_t index = 0;
      const char* const end = token.data() + token.size();
      const auto [rest, error] = std::from_chars(token.data(), end, index);
      at = error == std::errc() && rest == end && index < at->size() ? &at->at(index) : nullptr;
    } else {
      at = at->find_value(token);
    }
    if (at == nullptr) return nullptr;
  }
  return at;
}

bool Json::contains(std::string_view key) const { return find_value(key) != nullptr; }
bool Json::contains(const JsonPointer& pointer) const { return find_at(pointer) != nullptr; }

Json::iterator Json::find(std::string_view key) {
  Entry* entry = type_ == Type::kObject ? value_.object->find(key) : nullptr;
  return entry == nullptr ? end() : iterator(entry);
}
Json::const_iterator Json::find(std::string_view key) const {
  const Entry* entry = type_ == Type::kObject ? value_.object->find(key) : nullptr;
  return entry == nullptr ? end() : const_iterator(entry);
}

const Json& Json::at(std::string_view key) const {
  if (type_ != Type::kObject) refuse(kNoAt, "cannot use at() with");
  const Json* found = find_value(key);
  if (found == nullptr) throw key_error(key);
  return *found;
}
Json& Json::at(std::string_view key) { return const_cast<Json&>(std::as_const(*this).at(key)); }

const Json& Json::at(std::size_t index) const {
  if (type_ != Type::kArray) refuse(kNoAt, "cannot use at() with");
  if (index >= value_.elements->size()) throw index_error(index);
  return (*value_.elements)[index];
}
Json& Json::at(std::size_t index) { return const_cast<Json&>(std::as_const(*this).at(index)); }

const Json& Json::at(const JsonPointer& pointer) const {
  const Json* found = find_at(pointer);
  if (found == nullptr) throw key_error(fmt::format("{}", fmt::join(pointer.path_tokens(), "/")));
  return *found;
}

Json& Json::add(std::string key) { return value_.object->add(std::move(key)); }

Json& Json::operator[](std::string_view key) {
  if (is_null()) *this = object();
  if (type_ != Type::kObject) refuse(kNoIndexing, "cannot use operator[] with a string argument with");
  Entry* entry = value_.object->find(key);
  return entry != nullptr ? entry->value : add(std::string(key));
}

Json& Json::operator[](const JsonPointer& pointer) {
  Json* at = this;
  for (const std::string& token : pointer.path_tokens()) {
    const bool is_index = !token.empty() && token.find_first_not_of("0123456789") == std::string::npos;
    if (at->is_null()) *at = is_index ? array() : object();
    if (at->is_array()) {
      std::size_t index = 0;
      std::from_chars(token.data(), token.data() + token.size(), index);
      while (at->size() <= index) at->push_back(nullptr);
      at = &at->at(index);
    } else {
      at = &(*at)[std::string_view(token)];
    }
  }
  return *at;
}

void Json::push_back(Json element) {
  if (is_null()) *this = array();
  if (type_ != Type::kArray) refuse(kNoPushBack, "cannot use push_back() with");
  value_.elements->push_back(std::move(element));
}

void Json::update(const Json& other) {
  if (is_null()) *this = object();
  if (type_ != Type::kObject) refuse(kNoUpdate, "cannot use update() with");
  if (other.type_ != Type::kObject) other.refuse(kNoUpdate, "cannot use update() with");
  for (const Entry& entry : other.items()) (*this)[entry.key] = entry.value;
}

void Json::erase(std::string_view key) {
  if (type_ != Type::kObject) refuse(kNoErase, "cannot use erase() with");
  const Entry* entry = value_.object->find(key);
  if (entry == nullptr) return;
  std::vector<Entry>& entries = value_.object->entries;
  entries.erase(entries.begin() + (entry - entries.data()));
  value_.object->make_index();
}

void Json::sort_keys() {
  for (Json& child : *this) {
    if (child.is_structured()) child.sort_keys();
  }
  if (type_ != Type::kObject) return;
  std::ranges::sort(value_.object->entries, {}, &Entry::key);
  value_.object->make_index();
}

namespace {

std::string token_of(const std::string& key) {
  std::string token;
  for (const char c : key) token += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
  return token;
}

void flatten_into(const Json& json, const std::string& at, Json& out) {
  if (json.is_object() && !json.empty()) {
    for (const auto& [key, value] : json.items()) flatten_into(value, at + "/" + token_of(key), out);
  } else if (json.is_array() && !json.empty()) {
    std::size_t index = 0;
    for (const Json& element : json) flatten_into(element, fmt::format("{}/{}", at, index++), out);
  } else {
    out[at] = json.is_structured() ? Json() : json;
  }
}

}  // namespace

Json Json::flatten() const {
  Json out = object();
  flatten_into(*this, "", out);
  return out;
}

bool Json::equals_json(const Json& other) const {
  if (is_number() && other.is_number() && type_ != other.type_) {
    if (type_ == Type::kDouble || other.type_ == Type::kDouble) return get<double>() == other.get<double>();
    return type_ == Type::kInteger ? std::cmp_equal(value_.integer, other.value_.natural)
                                   : std::cmp_equal(value_.natural, other.value_.integer);
  }
  if (type_ != other.type_) return false;
  switch (type_) {
    case Type::kNull:
      return true;
    case Type::kBoolean:
      return value_.boolean == other.value_.boolean;
    case Type::kInteger:
      return value_.integer == other.value_.integer;
    case Type::kUnsigned:
      return value_.natural == other.value_.natural;
    case Type::kDouble:
      return value_.real == other.value_.real;
    case Type::kString:
      return *value_.text == *other.value_.text;
    case Type::kArray:
      return *value_.elements == *other.value_.elements;
    case Type::kObject:
      return std::ranges::equal(items(), other.items(),
                                [](const Entry& a, const Entry& b) { return a.key == b.key && a.value == b.value; });
  }
  return false;
}

JsonPointer::JsonPointer(std::string_view text) {
  while (!text.empty()) {
    text.remove_prefix(1);  // the leading '/'
    const std::string_view token = text.substr(0, text.find('/'));
    std::string& key = tokens_.emplace_back();
    for (std::size_t i = 0; i < token.size(); ++i) {
      const bool is_escaped = token[i] == '~' && i + 1 < token.size();
      key += !is_escaped ? token[i] : token[++i] == '1' ? '/' : '~';
    }
    text.remove_prefix(token.size());
  }
}

// --- Writing -----------------------------------------------------------------------------------------------------

namespace {

/// Writes a Json value as text. The serializer of the nlohmann JSON library writes strings and floating-point numbers.
class JsonWriter {
 public:
  /// `indent`: spaces per nesting level of the JSON text; 0: the text is one line.
  explicit JsonWriter(std::size_t indent) : indent_(indent) {}

  void write(const Json& json) {
    if (json.is_object()) return write_object(json);
    if (json.is_array()) return write_array(json);
    if (json.is_string()) return write_text(json.get_ref<const std::string&>());
    if (json.is_null()) {
      out_ += "null";
    } else if (json.is_boolean()) {
      out_ += json.get<bool>() ? "true" : "false";
    } else if (json.is_number_float()) {
      scalars_.dump(json.get<double>(), false, false, 0);
    } else if (json.is_number_unsigned()) {
      fmt::format_to(std::back_inserter(out_), "{}", json.get<std::uint64_t>());
    } else {
      fmt::format_to(std::back_inserter(out_), "{}", json.get<std::int64_t>());
    }
  }

  std::string take_text() { return std::move(out_); }

 private:
  void write_object(const Json& json) {
    if (json.empty()) return void(out_ += "{}");
    char before = '{';
    ++level_;
    for (const auto& [key, value] : json.items()) {
      begin_element(before);
      write_text(key);
      out_ += indent_ == 0 ? ":" : ": ";
      write(value);
    }
    end_container('}');
  }
  void write_array(const Json& json) {
    if (json.empty()) return void(out_ += "[]");
    char before = '[';
    ++level_;
    for (const Json& element : json) {
      begin_element(before);
      write(element);
    }
    end_container(']');
  }
  void begin_element(char& before) {
    out_ += std::exchange(before, ',');
    begin_line();
  }
  void end_container(char closing) {
    --level_;
    begin_line();
    out_ += closing;
  }
  void begin_line() {
    if (indent_ == 0) return;
    out_ += '\n';
    out_.append(level_ * indent_, ' ');
  }
  void write_text(const std::string& text) {
    const auto is_plain = [](char c) { return c >= ' ' && c < '\x7f' && c != '"' && c != '\\'; };
    if (!std::ranges::all_of(text, is_plain)) return scalars_.dump(text, false, false, 0);
    out_ += '"';
    out_ += text;
    out_ += '"';
  }

  std::size_t indent_, level_ = 0;
  std::string out_;
  nlohmann::detail::serializer<nlohmann::json> scalars_{nlohmann::detail::output_adapter<char, std::string>(out_), ' ',
                                                        nlohmann::json::error_handler_t::replace};
};

std::string written_text(const Json& json, std::size_t indent) {
  JsonWriter writer(indent);
  writer.write(json);
  return writer.take_text();
}

}  // namespace

std::string json_line(const Json& json) { return written_text(json, 0); }
std::string json_lines(const Json& json) { return written_text(json, 2) + "\n"; }
std::ostream& operator<<(std::ostream& out, const Json& json) { return out << json_line(json); }

// --- Reading -----------------------------------------------------------------------------------------------------

void throw_not_whole_number(std::string_view what, std::string_view min, std::string_view max) {
  throw InputError(fmt::format("{} is no whole number from {} to {}", what, min, max));
}

bool is_nested_deeper(std::string_view json, std::size_t levels) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > levels) return true;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return false;
}

void check_json_depth(std::string_view json, std::size_t levels) {
  if (is_nested_deeper(json, levels)) {
    throw InputError(fmt::format("is nested too deeply; allowed: {} levels", levels));
  }
}

/// Builds a Json value from the events of the nlohmann JSON parser.
class JsonBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return add_value(Json()); }
  bool boolean(bool value) override { return add_value(value); }
  bool number_integer(number_integer_t value) override { return add_value(value); }
  bool number_unsigned(number_unsigned_t value) override { return add_value(value); }
  bool number_float(number_float_t value, const string_t& /*digits*/) override { return add_value(value); }
  bool string(string_t& value) override { return add_value(std::move(value)); }
  bool binary(binary_t& /*bytes*/) override { return false; }
  bool key(string_t& name) override {
    Json::Object& object = *open_.back()->value_.object;
    Json::Entry* entry = object.find(name);
    if (entry == nullptr && object.entries.size() == kMostJsonKeys) {
      throw InputError(fmt::format("has an object of too many keys; allowed: {} keys", kMostJsonKeys));
    }
    member_ = entry != nullptr ? &entry->value : &object.add(std::move(name));
    return true;
  }
  bool start_object(std::size_t /*elements*/) override { return begin_container(Json::object()); }
  bool start_array(std::size_t /*elements*/) override { return begin_container(Json::array()); }
  bool end_object() override { return end_container(); }
  bool end_array() override { return end_container(); }
  bool parse_error(std::size_t byte, const std::string& /*token*/, const nlohmann::detail::exception& error) override {
    const bool is_syntax = dynamic_cast<const nlohmann::json::parse_error*>(&error) != nullptr;
    throw JsonError(is_syntax ? JsonError::Kind::kSyntax : JsonError::Kind::kNumberRange, error.what(), byte);
  }

  Json take_value() { return std::move(root_); }

 private:
  bool add_value(Json value) {
    add_to_parent(std::move(value));
    return true;
  }
  bool begin_container(Json value) {
    open_.push_back(&add_to_parent(std::move(value)));
    return true;
  }
  bool end_container() {
    Json& done = *open_.back();
    if (done.is_array()) done.value_.elements->shrink_to_fit();
    if (done.is_object()) done.value_.object->entries.shrink_to_fit();
    open_.pop_back();
    return true;
  }
  Json& add_to_parent(Json value) {
    if (open_.empty()) return root_ = std::move(value);
    if (open_.back()->is_object()) return *member_ = std::move(value);
    std::vector<Json>& elements = *open_.back()->value_.elements;
    elements.push_back(std::move(value));
    return elements.back();
  }

  Json root_;
  std::vector<Json*> open_;  ///< arrays and objects whose end has not been parsed, outermost first
  Json* member_ = nullptr;   ///< value of the last parsed key
};

Json parse_json(std::string_view text, std::size_t levels) {
  check_json_depth(text, levels);
  JsonBuilder builder;
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take_value();
}

Json parse_json(std::istream& text) {
  JsonBuilder builder;
  nlohmann::json::sax_parse(text, &builder, nlohmann::json::input_format_t::json, false);
  return builder.take_value();
}

}  // namespace sim
