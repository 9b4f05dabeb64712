"""How messages look to people: in one line (`brief`), as the docstring of their class (`described`), in a notebook (`page`)."""
