//! Verilog names: no reserved word, no name twice.

use std::collections::HashSet;
use std::sync::LazyLock;

/// Reserved words of Verilog-2001 and of SystemVerilog, which most tools read it as.
static RESERVED: LazyLock<HashSet<&str>> = LazyLock::new(|| {
    "accept_on alias always always_comb always_ff always_latch and assert assign assume automatic \
    before begin bind bins binsof bit break buf bufif0 bufif1 byte case casex casez cell chandle checker class clocking \
    cmos config const constraint context continue cover covergroup coverpoint cross deassign default defparam design \
    disable dist do edge else end endcase endchecker endclass endclocking endconfig endfunction endgenerate endgroup \
    endinterface endmodule endpackage endprimitive endprogram endproperty endsequence endspecify endtable endtask enum \
    event eventually expect export extends extern final first_match for force foreach forever fork forkjoin function \
    generate genvar global highz0 highz1 if iff ifnone ignore_bins illegal_bins implements implies import incdir include \
    initial inout input inside instance int integer interconnect interface intersect join join_any join_none large let \
    liblist library local localparam logic longint macromodule matches medium modport module nand negedge nettype new \
    nexttime nmos nor noshowcancelled not notif0 notif1 null or output package packed parameter pmos posedge primitive \
    priority program property protected pull0 pull1 pulldown pullup pulsestyle_ondetect pulsestyle_onevent pure rand \
    randc randcase randsequence rcmos real realtime ref reg reject_on release repeat restrict return rnmos rpmos rtran \
    rtranif0 rtranif1 s_always s_eventually s_nexttime s_until s_until_with scalared sequence shortint shortreal \
    showcancelled signed small soft solve specify specparam static string strong strong0 strong1 struct super supply0 \
    supply1 sync_accept_on sync_reject_on table tagged task this throughout time timeprecision timeunit tran tranif0 \
    tranif1 tri tri0 tri1 triand trior trireg type typedef union unique unique0 unsigned until until_with untyped use \
    uwire var vectored virtual void wait wait_order wand weak weak0 weak1 while wildcard wire with within wor xnor xor"
    .split_whitespace()
    .collect()
});

/// The names of one scope that are taken.
#[derive(Debug, Default, Clone)]
pub(crate) struct Names {
    taken: HashSet<String>,
}

impl Names {
    /// Nothing else gets this name.
    pub fn reserve(&mut self, name: &str) {
        self.taken.insert(name.into());
    }

    /// A free name nearest to the wanted one: `$` becomes `_`, a reserved word gets a trailing `_`, a taken name a number.
    pub fn take(&mut self, wanted: &str) -> String {
        let mut plain = wanted.trim_start_matches("r#").replace(['$', '.'], "_");
        if RESERVED.contains(plain.as_str()) {
            plain.push('_');
        }
        let numbered = (2..).map(|n| format!("{plain}_{n}"));
        let free = std::iter::once(plain.clone()).chain(numbered).find(|name| !self.taken.contains(name));
        let name = free.expect("the numbers do not end");
        self.taken.insert(name.clone());
        name
    }
}

/// `PairBuffer` as `pair_buffer`, `DFFHold` as `dff_hold`.
pub(crate) fn snake_case(name: &str) -> String {
    let letters: Vec<char> = name.chars().collect();
    let mut snake = String::new();
    for (i, &letter) in letters.iter().enumerate() {
        let after_small = i > 0 && (letters[i - 1].is_lowercase() || letters[i - 1].is_ascii_digit());
        let ends_capitals = i > 0
            && letters[i - 1].is_uppercase()
            && letters.get(i + 1).is_some_and(|next| next.is_lowercase());
        if letter.is_uppercase() && (after_small || ends_capitals) {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_free_and_not_reserved() {
        let mut names = Names::default();
        let given: Vec<_> =
            ["reg", "banks$3", "banks_3", "logic"].iter().map(|name| names.take(name)).collect();
        assert_eq!(given, ["reg_", "banks_3", "banks_3_2", "logic_"]);
    }

    #[test]
    fn type_names_become_snake_case() {
        let given: Vec<_> =
            ["PairBuffer", "DFFHold", "Mac16", "X"].iter().map(|name| snake_case(name)).collect();
        assert_eq!(given, ["pair_buffer", "dff_hold", "mac16", "x"]);
    }
}
