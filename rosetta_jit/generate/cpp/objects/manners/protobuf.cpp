/* What protoc generates: setters, `mutable_…`, `has_…`, `clear_…`; repeated fields and maps are containers. */

/* == member decode == */
(*$object.mutable_$field())

/* == member encode == */
$object.$field()

/* == laid out == */

/* == number decode == */
$object.set_$field(rosetta_jit::detail::as<decltype($object.$field())>($row));

/* == number encode == */
rosetta_jit::detail::put($row, $object.$field());

/* == optional is there == */
$object.has_$field()

/* == optional clear == */
if ($object.has_$field()) {
    $object.clear_$field();
}

/* == optional make == */

/* == optional value == */
$at

/* == link is there == */
$object.has_$field()

/* == link clear == */
if ($object.has_$field()) {
    $object.clear_$field();
}

/* == link make == */

/* == link value == */
$at

/* == union clear == */
$object.clear_$field();

/* == case is there == */
$object.has_$case()

/* == case make == */

/* == map clear == */
$at.clear();

/* == map entry == */
$at[$key]

/* == unknown decode == */
rosetta_jit::detail::keep_unknown($object, from.$lane, $row);

/* == unknown encode == */
rosetta_jit::detail::take_unknown(to.$lane, $row, $object);
