# Reads Vivado's reports. Each reader takes the text of one report and returns its violations, one line each; a clean report has none.
# A line of an unknown form is an error that names the line, and so is a part that is missing: no report passes unread.
# The forms are those of Vivado 2018.2 to 2026.1. Plain Tcl, so that the readers run without Vivado.

# Ports of the DRAM, which its controller constrains by itself.
set dram_ports {ddr3_*}

# Sections of check_timing.
set timing_checks {
    no_clock constant_clock pulse_width_clock unconstrained_internal_endpoints no_input_delay no_output_delay multiple_clock
    generated_clocks loops partial_input_delay partial_output_delay latch_loops
}

proc unknown {number line} { error "line $number has an unknown form: '[string trim $line]'" }

# Lines below the title of a report: number, line, number, line and so on.
proc below {text title} {
    set number 0
    set is_below 0
    set lines {}
    foreach line [split $text "\n"] {
        incr number
        set line [string trimright $line]
        if {$is_below} { lappend lines $number $line } elseif {[string trim $line] eq $title} { set is_below 1 }
    }
    if {!$is_below} { error "the title '$title' is missing" }
    return $lines
}

# Sections of a report: a dict from each underlined title, without its number, to the lines below it.
proc sections {lines} {
    set sections [dict create]
    for {set i 0} {$i < [llength $lines]} {incr i 2} {
        lassign [lrange $lines $i $i+3] number line next_number next
        if {[regexp {^\d+\.\d* (.+)$} $line all title] && [regexp {^-+$} $next]} {
            dict set sections $title {}
            incr i 2
        } elseif {[info exists title] && [dict exists $sections $title]} {
            dict lappend sections $title $number $line
        }
    }
    return $sections
}

proc section {sections title} {
    if {![dict exists $sections $title]} { error "the section '$title' is missing" }
    return [dict get $sections $title]
}

# Cells of a line of a table that is drawn with bars.
proc cells {line} { return [lmap cell [lrange [split $line "|"] 1 end-1] { string trim $cell }] }

proc matches {name patterns} {
    foreach pattern $patterns {
        if {[string match [string map {\[ \\\[ \] \\\]} $pattern] $name]} { return 1 }
    }
    return 0
}

# check_timing -verbose.

# Ports that the constraints except on purpose, as patterns: `input` and `output` by a false path, `clock` by a clock that leaves there.
proc excepted_ports {constraints} {
    set ports [dict create input {} output {} clock {}]
    set objects {\[get_ports (\{[^\}]*\}|\S+)\]}
    foreach line [split $constraints "\n"] {
        if {[regexp "^set_false_path -(from|to) $objects\$" $line all end names]} {
            dict lappend ports [dict get {from input to output} $end] {*}[lindex $names 0]
        } elseif {[regexp "^create_generated_clock .*$objects\$" $line all names]} {
            dict lappend ports clock {*}[lindex $names 0]
        }
    }
    return $ports
}

# Sentences of a section: number of the line, count, words, names listed below.
proc sentences {lines} {
    set sentences {}
    foreach {number line} $lines {
        set line [string trim $line]
        regsub { \((?:HIGH|MEDIUM|LOW)\)$} $line "" words
        if {$line eq ""} {
            continue
        } elseif {[regexp {^There (?:is|are) (\d+) (.+)$} [string trimright $words "."] all count what]} {
            lappend sentences [list $number $count $what {}]
        } elseif {[llength $sentences] > 0 && [lindex $sentences end 1] > 0} {
            lset sentences end 3 [list {*}[lindex $sentences end 3] $line]
        } else {
            unknown $number $line
        }
    }
    return $sentences
}

# Ports that a sentence may list, as patterns; an error for a sentence that is not about ports.
proc permitted_ports {what excepted} {
    global dram_ports
    if {![regexp {^(input )?ports? with (?:no|partial) (input|output) delay (.+)$} $what all is_input direction why]} { return "" }
    switch -glob $why {
        specified { return $dram_ports }
        "but user has a false path constraint" { return [concat $dram_ports [dict get $excepted $direction]] }
        "but with a timing clock defined on it*" { return [concat $dram_ports [dict get $excepted clock]] }
    }
    return ""
}

# What no clock reaches and no delay limits, less the ports that the constraints except.
proc timing_violations {text excepted} {
    global timing_checks
    set violations {}
    set missing $timing_checks
    dict for {title lines} [sections [below $text "check_timing report"]] {
        if {![regexp {^checking (\w+)(?: \((\d+)\))?$} $title all check total]} { error "the section '$title' has an unknown form" }
        set missing [lsearch -all -inline -not -exact $missing $check]
        set sum 0
        foreach sentence [sentences $lines] {
            lassign $sentence number count what names
            incr sum $count
            set permitted [permitted_ports $what $excepted]
            if {$permitted eq ""} {
                if {$count > 0} { lappend violations "$check: $count $what: [join $names {, }]" }
                continue
            }
            if {[llength $names] != $count} { error "line $number counts $count ports and lists [llength $names]" }
            foreach name $names {
                if {![matches $name $permitted]} { lappend violations "$check: $name: $what" }
            }
        }
        if {$total ni [list "" $sum]} { error "the section '$title' lists $sum" }
    }
    if {[llength $missing] > 0} { error "the section 'checking [lindex $missing 0]' is missing" }
    return $violations
}

# report_bus_skew: `expected` buses have a limit of their skew, and keep it.
proc skew_violations {text expected} {
    set lines [below $text "Bus Skew Report"]
    if {[lsearch -exact $lines "No bus skew constraints"] >= 0} { return [list "0 buses have a limit of their skew, expected $expected"] }
    set violations {}
    set buses 0
    set from ""
    foreach {number line} [section [sections $lines] "Bus Skew Report Summary"] {
        if {$line eq "" || [regexp {^(Id  Position |--  ---)} $line]} { continue }
        if {[regexp {^(\d+) +\d+ +(\S.*)$} $line all id rest]} {
            if {$from ne "" || $id != $buses + 1} { unknown $number $line }
            incr buses
            set from [expr {[regexp {[^\s\{\}]+/[^\s\{\}]+} $rest name] ? $name : $rest}]
        } elseif {$from eq "" || ![string match " *" $line]} {
            unknown $number $line
        }
        if {[regexp { (?:Slow|Fast) +-?[\d.]+ +-?[\d.]+ +(-?[\d.]+)$} $line all slack]} {
            if {[string match "-*" $slack]} { lappend violations "bus $buses from $from: slack $slack ns" }
            set from ""
        }
    }
    if {$from ne ""} { error "bus $buses has no slack" }
    if {$buses != $expected} { lappend violations "$buses buses have a limit of their skew, expected $expected" }
    return $violations
}

# report_pulse_width: the worst checks of each clock.
proc pulse_violations {text} {
    set number 0
    set rows 0
    set clock ""
    set violations {}
    foreach line [split $text "\n"] {
        incr number
        set line [string trimright $line]
        if {[regexp {^Clock Name: +(\S+)$} $line all clock]} { continue }
        # A header and a title come before the first clock.
        if {$clock eq "" || $line eq "" || [regexp {^((Waveform|Period)(\(ns\))?:|Sources:|Check Type | |-+$)} $line]} { continue }
        if {![regexp {^(M(?:in|ax) (?:Period|Skew)|(?:Low|High) Pulse Width) +(Slow|Fast|n/a) +\S+ +\S+ +-?[\d.]+ +-?[\d.]+ +(-?[\d.]+) +(.+)$} \
            $line all check corner slack place]} { unknown $number $line }
        incr rows
        if {[string match "-*" $slack]} { lappend violations "$clock: $check at [lindex [split $place] end]: slack $slack ns" }
    }
    if {$rows == 0} { error "no clock is checked" }
    return $violations
}

# report_cdc -details.
proc crossing_violations {text} {
    set violations {}
    set expected [dict create]
    set listed [dict create]
    foreach {number line} [below $text "CDC Report"] {
        if {$line eq "" || [regexp {^(-+ +-|ID +Severity |Row +ID +Severity |Source Clock: |Destination Clock: |CDC Type: )} $line]} { continue }
        if {[regexp {^(CDC-\d+) +(?:Info|Warning|Critical) +(\d+) +\S} $line all rule count]} {
            dict set expected $rule $count
        } elseif {[regexp {^ *\d+ +(CDC-\d+) +(Info|Warning|Critical) +(\S.*)$} $line all rule severity rest]} {
            dict incr listed $rule
            set cells [split [regsub -all { {2,}} $rest "\t"] "\t"]
            if {$severity eq "Critical"} { lappend violations "$rule: [lindex $cells 0]: from [lindex $cells end-1] to [lindex $cells end]" }
        } else {
            unknown $number $line
        }
    }
    if {[dict size $listed] == 0} { error "no crossing is listed" }
    dict for {rule count} $expected {
        set rows [expr {[dict exists $listed $rule] ? [dict get $listed $rule] : 0}]
        if {$rows != $count} { error "$rule counts $count crossings and lists $rows" }
    }
    return $violations
}

# report_methodology and report_drc: errors and critical warnings, less the rules of `tolerated`.
proc rule_violations {text title tolerated} {
    set sections [sections [below $text $title]]
    set counted [dict create]
    set total ""
    foreach {number line} [section $sections "REPORT SUMMARY"] {
        regexp {^ *(?:Violations|Checks) found: *(\d+)$} $line all total
        if {![string match "|*" $line]} { continue }
        set cells [cells $line]
        if {[lindex $cells 0] eq "Rule"} { continue }
        if {[llength $cells] < 4 || ![string is integer -strict [lindex $cells end]]} { unknown $number $line }
        dict set counted [lindex $cells 0] [lindex $cells end]
    }
    if {$total eq ""} { error "the number of violations is missing" }
    if {$total != [tcl::mathop::+ {*}[dict values $counted]]} { error "$total violations were found, but the table counts others" }
    set violations {}
    set details [section $sections "REPORT DETAILS"]
    for {set i 0} {$i < [llength $details]} {incr i 2} {
        lassign [lrange $details $i $i+5] number line name_number name text_number text
        if {![regexp {^(\S+)#(\d+) (\w[\w ]*)$} $line all rule index severity]} { continue }
        if {$severity ni {Advisory Warning "Critical Warning" Error}} { unknown $number $line }
        dict incr counted $rule -1
        if {$severity in {"Critical Warning" Error} && $rule ni $tolerated} { lappend violations "$rule#$index: $text" }
    }
    dict for {rule left} $counted { if {$left != 0} { error "$rule: the table and the details differ by $left" } }
    return $violations
}

# report_clock_interaction: no pair of clocks is timed that has no common source.
proc clock_violations {text} {
    set violations {}
    set ruler {}
    set above {}
    set pairs 0
    foreach {number line} [below $text "Clock Interaction Report"] {
        if {[llength $ruler] == 0} {
            if {[regexp {^-+( +-+){4,}$} $line]} {
                set ruler [regexp -all -inline -indices -- {-+} $line]
                set columns [lmap column $ruler { string trim [join [lmap head [lrange $above end-1 end] { string trim [string range $head {*}$column] }]] }]
                foreach name {"From Clock" "To Clock" "Inter-Clock Constraints"} {
                    if {$name ni $columns} { error "the column '$name' is missing" }
                }
            }
            lappend above $line
        } elseif {$line ne ""} {
            incr pairs
            set row [lmap column $ruler { string trim [string range $line {*}$column] }]
            lassign [lmap name {"From Clock" "To Clock" "Inter-Clock Constraints"} { lindex $row [lsearch -exact $columns $name] }] from to constraint
            if {![regexp -nocase {^(Partial )?(Timed|False Path|(Asynchronous|Exclusive) Groups|Max Delay Datapath Only|Multicycle Path|User Ignored Paths)( \(unsafe\))?$} \
                $constraint all partial kind which unsafe]} { unknown $number $line }
            if {$unsafe ne ""} { lappend violations "from $from to $to: $constraint" }
        }
    }
    if {$pairs == 0} { error "no pair of clocks is listed" }
    return $violations
}

# report_utilization: nothing is used more than there is, and every module has contents.
proc utilization_violations {text} {
    set sections [sections [below $text "Utilization Design Information"]]
    set violations {}
    foreach title {"Slice Logic" Memory DSP} {
        set columns {}
        foreach {number line} [section $sections $title] {
            if {![string match "|*" $line]} { continue }
            set row [cells $line]
            if {"Util%" in $row} { set columns $row; continue }
            if {[llength $row] != [llength $columns]} { unknown $number $line }
            lassign [lmap name {"Site Type" Used Available "Util%"} { lindex $row [lsearch -exact $columns $name] }] site used available percent
            if {$percent ne "" && ![string is double -strict [string trimleft $percent "<"]]} { unknown $number $line }
            if {$percent ne "" && [string trimleft $percent "<"] > 100} { lappend violations "$site: $used of $available are used" }
        }
        if {[llength $columns] == 0} { error "the section '$title' has no table" }
    }
    foreach {number line} [section $sections "Black Boxes"] {
        if {[string match "|*" $line] && [lindex [cells $line] 0] ne "Ref Name"} { lappend violations "black box [lindex [cells $line] 0]" }
    }
    return $violations
}
