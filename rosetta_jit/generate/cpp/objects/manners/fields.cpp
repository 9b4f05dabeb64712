/* How the fields of a class are reached that are members of it. Each section is one place of generated code; other holders replace some. */

/* == member decode == */
$object.$field

/* == member encode == */
$object.$field

/* == laid out == */
$object.$field

/* == number decode == */
rosetta_jit::detail::set($at, $row);

/* == number encode == */
rosetta_jit::detail::put($row, $at);

/* == sequence decode == */
rosetta_jit::detail::assign_span($at, from.$lane, $row, bytes);

/* == sequence encode == */
rosetta_jit::detail::${how}_span(to.$lane, $row, $at);

/* == address == */
rosetta_jit::detail::point_span<$type>($row, $at);

/* == list within == */
rosetta_jit::detail::point_list($row, $at);

/* == message within == */
rosetta_jit::detail::point_object($row, $at);

/* == texts decode == */
rosetta_jit::detail::assign_texts($at, from.$lane, $row, from.$texts, bytes);

/* == list decode == */
rosetta_jit::detail::resize_to($at, $row.count);

/* == list encode == */
const std::int64_t $count = rosetta_jit::detail::count_of($at);
const std::int64_t $start = rosetta_jit::detail::$take(to.$lane, $count);
$row = {$start, $count};

/* == numbers == */
rosetta_jit::detail::rows_of<$row, $count>($at)

/* == sized == */
rosetta_jit::detail::sized<$row>($at, $count)

/* == open == */
$lane = rosetta_jit::detail::opened($at, $count);

/* == open texts == */
$lane = rosetta_jit::detail::opened_texts($at, $count);

/* == emptied == */
rosetta_jit::detail::resize_to($at, 0);

/* == text of a list == */
$lane.put($index, bytes + ($start), $size);

/* == text == */
rosetta_jit::detail::assign($at, bytes + ($start), $size);

/* == checked text of a list == */
$lane.read($index, bytes + ($start), $size)

/* == checked text == */
rosetta_jit::detail::read_text($at, bytes + ($start), $size)

/* == element decode == */
rosetta_jit::detail::element($at, $index)

/* == begin encode == */
const auto $first = std::begin($at);

/* == element encode == */
$at[$index]

/* == direct == */
$at
