/* Classes that are generated: members, std::optional, std::variant, std::map, and std::unique_ptr where a type contains itself. */

/* == optional is there == */
$at.has_value()

/* == optional clear == */
$at.reset();

/* == optional make == */
if (!$at.has_value()) {
    $at.emplace();
}

/* == optional value == */
(*$at)

/* == link is there == */
$at != nullptr

/* == link clear == */
$at.reset();

/* == link make == */
$at = std::make_unique<typename std::remove_reference_t<decltype($at)>::element_type>();

/* == link value == */
(*$at)

/* == union clear == */
$at.template emplace<0>();

/* == case is there == */
$at.index() == $number

/* == case make == */
$at.template emplace<$number>();

/* == case decode == */
std::get<$number>($at)

/* == case encode == */
std::get<$number>($at)

/* == map clear == */
$at.clear();

/* == map entry == */
$at[$key]

/* == unknown decode == */
rosetta_jit::detail::assign_span($object.unknown_fields, from.$lane, $row, bytes);

/* == unknown encode == */
rosetta_jit::detail::take_span(to.$lane, $row, $object.unknown_fields);
