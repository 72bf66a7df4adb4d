"""The grammar of configuration files, and the message of each kind of mistake."""

import numpy as np
import pytest
from openmmhelfrich import vcm
from openmmhelfrich.vcm.grammar import read_sections
from vcm_files import Folder, line_of


@pytest.fixture
def folder(tmp_path, lumpy):
    return Folder(tmp_path, lumpy)


def refuses(folder, text, key, *fragments, word=None):
    """The text is refused with file, line and key, and these fragments."""
    message = folder.message(text)
    line = line_of(text, word or key.split()[-1])
    assert message.startswith(f"config.txt:{line}: "), message
    for fragment in (key, *fragments):
        assert fragment in message


class TestLines:
    def test_words_are_separated_by_any_white_space(self, folder):
        cfg = folder.read("  NodeMass\t \t7   \r\n\n   \n\tScale 2")
        (membrane,) = cfg.membranes
        assert membrane.settings["NodeMass"] == 7
        assert membrane.settings["Scale"] == 2

    def test_a_comment_starts_at_the_start_of_a_word(self, folder):
        cfg = folder.read("#NodeMass 9\nNodeMass 7 # 8\nScale 2 #3 4", "ProjectName a#b")
        assert cfg.membranes[0].settings["NodeMass"] == 7
        assert cfg.membranes[0].settings["Scale"] == 2
        assert cfg.name == "a#b"

    def test_a_negative_number_opens_no_section(self, folder):
        cfg = folder.read("MeanspontaneousCurvature -0.5")
        assert cfg.membranes[0].settings["MeanspontaneousCurvature"] == -0.5

    def test_byte_order_mark(self, folder):
        path = folder.path / "bom.txt"
        path.write_bytes(b"\xef\xbb\xbf" + folder.text("NodeMass 3").encode())
        assert vcm.read(path).membranes[0].settings["NodeMass"] == 3

    def test_sections_in_any_order(self, folder):
        path = folder.write(
            "-InteractionTable\nM0 0\n-Membrane 0\nMeshFile mesh.ply\n"
            "-GeneralParameters\nProjectName late\n"
        )
        assert vcm.read(path).name == "late"

    def test_no_general_section_gives_defaults(self, folder):
        cfg = vcm.read(folder.write("-Membrane\nMeshFile mesh.ply\n"))
        assert (cfg.name, cfg.temperature) == ("VCProject", 310)

    def test_labels_default_to_numbers(self, folder):
        path = folder.write("-Membrane\nMeshFile mesh.ply\n-Membrane\nMeshFile mesh.ply\n")
        assert [section.label for section in read_sections(path)] == ["0", "1"]


class TestInheritance:
    def parents(self, folder, child):
        text = folder.text("NodeMass 3\nScale 2", more=f"-Membrane B like 0\n{child}")
        return vcm.read(folder.write(text)).membranes

    def test_takes_all_lines_of_the_parent(self, folder):
        a, b = self.parents(folder, "")
        assert b.settings["NodeMass"] == 3
        assert np.array_equal(b.mesh.vertices, a.mesh.vertices)

    def test_own_lines_take_precedence(self, folder):
        a, b = self.parents(folder, "NodeMass 5")
        assert (a.settings["NodeMass"], b.settings["NodeMass"]) == (3, 5)
        assert b.settings["Scale"] == 2

    def test_over_two_generations(self, folder):
        text = folder.text("NodeMass 3", more="-Membrane B x 0\nScale 2\n-Membrane C x B")
        third = vcm.read(folder.write(text)).membranes[2]
        assert (third.settings["NodeMass"], third.settings["Scale"]) == (3, 2)

    def test_errors_name_the_line_of_the_parent(self, folder):
        text = folder.text("NodeMass heavy", more="-Membrane B x 0")
        refuses(folder, text, "NodeMass")

    def test_unknown_parent(self, folder):
        text = folder.text(more="-Membrane B inherits Zero")
        refuses(folder, text, "section -Membrane", "Zero", "known are 0", word="-Membrane B")

    def test_parent_must_come_first(self, folder):
        text = "-Membrane A x B\nMeshFile mesh.ply\n-Membrane B\nMeshFile mesh.ply\n"
        refuses(folder, text, "section -Membrane", "there is none before it", word="-Membrane A")

    def test_a_word_without_a_parent(self, folder):
        text = folder.text(more="-Membrane B inherits")
        refuses(folder, text, "section -Membrane", "'B inherits'", word="-Membrane B")


class TestMistakes:
    def test_unknown_key_names_the_nearest(self, folder):
        text = folder.text("NodeMas 50")
        refuses(folder, text, "key NodeMas", "did you mean NodeMass?", word="NodeMas ")

    def test_unknown_key_in_the_wrong_case(self, folder):
        text = folder.text(general="temperatureInKelvin 300")
        refuses(folder, text, "temperatureInKelvin", "did you mean TemperatureinKelvin?")

    def test_unknown_key_that_is_like_none(self, folder):
        refuses(folder, folder.text("Xqzzy 1"), "Xqzzy", "there is no such key", "docs/vcm.md")

    def test_key_of_another_section(self, folder):
        text = folder.text(general="NodeMass 50")
        refuses(folder, text, "NodeMass", "belongs in a section -Membrane")

    def test_unknown_key_can_be_skipped(self, folder):
        cfg = folder.read("NodeMas 50\nScale 2", ignore_unknown=True)
        assert cfg.membranes[0].settings["NodeMass"] == 1
        assert cfg.membranes[0].settings["Scale"] == 2

    def test_the_rest_of_a_broken_comment_is_skipped_with_a_warning(self, folder):
        with pytest.warns(vcm.ConfigWarning, match=r"config\.txt:6: skipped 'eWCA potential"):
            folder.read("# the least height of th\neWCA potential in nano meters")

    def test_a_misspelt_key_after_a_comment_is_no_broken_comment(self, folder):
        text = folder.text("# its mass\nNodeMas is not prose")
        refuses(folder, text, "NodeMas", "did you mean NodeMass?")

    def test_an_unknown_key_with_a_number_is_no_broken_comment(self, folder):
        refuses(folder, folder.text("# note\nXqzzy is 5"), "Xqzzy", "there is no such key")

    def test_prose_that_follows_no_comment(self, folder):
        refuses(folder, folder.text("eWCA potential in nano meters"), "eWCA", "no such key")

    def test_repeated_key(self, folder):
        message = folder.refused("NodeMass 3\nScale 1\nNodeMass 4")
        assert message.startswith("config.txt:7: key NodeMass: it was given before, in line 5")

    def test_line_before_the_first_section(self, folder):
        refuses(folder, "NodeMass 3\n" + folder.text(), "NodeMass", "before the first section")

    def test_unknown_section(self, folder):
        text = folder.text(more="-Membrain 1")
        refuses(folder, text, "section -Membrain", "did you mean -Membrane?")

    @pytest.mark.parametrize("kind", ["Actin", "ECM", "Chromatin"])
    def test_section_that_is_not_done(self, folder, kind):
        text = folder.text(more=f"-{kind} 0\nMeshFile x.ply")
        refuses(folder, text, f"section -{kind}", "only membranes are simulated")

    def test_two_general_sections(self, folder):
        text = folder.text(more="-GeneralParameters\nSeed 1")
        message = folder.message(text)
        assert message.startswith("config.txt:6: section -GeneralParameters: it was opened before")
        assert "line 1" in message

    def test_repeated_label(self, folder):
        message = folder.message(folder.text(more="-Membrane 0\nMeshFile mesh.ply"))
        assert "section -Membrane: the label 0 was used before, in line 3" in message

    def test_no_membrane(self, folder):
        message = folder.message("-GeneralParameters\nSeed 1\n")
        assert "no section -Membrane" in message

    def test_no_file(self, folder):
        with pytest.raises(FileNotFoundError, match=r"nowhere\.txt"):
            vcm.read(folder.path / "nowhere.txt")

    def test_toml_is_refused(self, folder):
        path = folder.path / "own.toml"
        path.write_text("[membrane]\n")
        with pytest.raises(vcm.ConfigError, match="TOML"):
            vcm.read(path)

    def test_error_is_a_value_error(self):
        assert issubclass(vcm.ConfigError, ValueError)

    @pytest.mark.parametrize("seed", [-1, 2**31])
    def test_seed_out_of_range(self, folder, seed):
        with pytest.raises(ValueError, match=str(seed)):
            folder.read(seed=seed)


class TestInteractionTable:
    def test_labels_do_not_matter(self, folder):
        cfg = folder.read(more="-Membrane B x 0\nScale 5", table="anything LJ\nanything 0 WCA")
        assert cfg.table == [["LJ"], ["0", "WCA"]]

    def test_no_table_means_no_interaction(self, folder):
        assert folder.read(more="-Membrane B x 0\n").table == [["0"], ["0", "0"]]

    def test_unknown_interaction(self, folder):
        text = folder.text(table="M0 WCAF")
        refuses(folder, text, "key M0", "no interaction 'WCAF'", "did you mean WCAFC?", word="M0")

    def test_row_too_short(self, folder):
        text = folder.text(more="-Membrane B x 0", table="A 0\nB 0")
        refuses(folder, text, "key B", "needs 2 words", "got 1", word="B 0")

    def test_too_few_rows(self, folder):
        text = folder.text(more="-Membrane B x 0", table="A 0")
        refuses(
            folder,
            text,
            "section -InteractionTable",
            "one row per membrane, 2; it has 1",
            word="-InteractionTable",
        )

    def test_too_many_rows(self, folder):
        text = folder.text(table="A 0\nB 0 0")
        refuses(folder, text, "key B", "one row per membrane, 1; it has 2", word="B 0")
